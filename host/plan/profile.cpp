// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Built-in profiles and profile files.
#include <fmt/format.h>
#include <toml++/toml.h>

#include <array>
#include <filesystem>
#include <string_view>

#include "formats/image.h"
#include "host/base/error.h"
#include "host/plan/plan.h"

namespace vitrine {
namespace {

constexpr uint64_t kMiB = uint64_t{1} << 20;

// Units: a quarter of what one core decodes in a frame (about 1000 units a microsecond on one core of an x86-64 server; half of
// that taken for boards), so that the rest of the frame is left for composing and drawing. Uploads: what the class of device copies
// in a quarter of a frame.
const std::array<Profile, 4>& built_in_profiles() {
  static const std::array<Profile, 4> profiles{{
      // software GL on a server or laptop: tests, demos
      {"osmesa-30", 8'000'000, 96 * kMiB, 1024 * kMiB, 2, 30, SurfaceFilter::kTrilinear},
      // small PC with integrated graphics
      {"kiosk-60", 4'000'000, 48 * kMiB, 512 * kMiB, 2, 60, SurfaceFilter::kTrilinear},
      // 64-bit Arm board with GL ES 3.0
      {"board-60", 1'000'000, 12 * kMiB, 128 * kMiB, 1, 60, SurfaceFilter::kTrilinear},
      // PC with a graphics card
      {"desktop-120", 4'000'000, 64 * kMiB, 1024 * kMiB, 3, 120, SurfaceFilter::kAnisotropic4},
  }};
  return profiles;
}

std::string built_in_names() {
  std::string names;
  for (const Profile& profile : built_in_profiles()) names += (names.empty() ? "" : ", ") + profile.name;
  return names;
}

std::string filter_names() {
  std::string names;
  for (const fb::SurfaceFilter filter : fb::EnumValuesSurfaceFilter())
    names += (names.empty() ? "" : ", ") + std::string(fb::EnumNameSurfaceFilter(filter));
  return names;
}

constexpr std::string_view kName = "name", kFilter = "texture_filter";
struct Key {
  std::string_view name;
  int64_t lowest, highest;
};
constexpr Key kUnits{"units_per_frame", 1, int64_t{1} << 40}, kUpload{"upload_bytes_per_frame", 1, int64_t{1} << 32},
    kCache{"cache_bytes", 1, int64_t{1} << 32}, kSupersampling{"supersampling", 1, 4}, kRate{"frames_per_second", 1, 1000};

// A TOML table, every key of which must be known and used.
class ProfileFile {
 public:
  explicit ProfileFile(const std::string& path) : path_(path), table_(parse(path)) {
    for (const auto& [key, value] : table_) {
      if (!known(key))
        throw InputError(path_, fmt::format("unknown key \"{}\"", key.str()),
                         "use name, units_per_frame, upload_bytes_per_frame, cache_bytes, supersampling, frames_per_second, "
                         "texture_filter");
    }
  }

  int64_t required(const Key& key) const {
    if (!table_.contains(key.name))
      throw InputError(path_, fmt::format("\"{}\" is missing", key.name), fmt::format("add it: {} = ...", key.name));
    return number(key);
  }
  int64_t optional(const Key& key, int64_t absent) const { return table_.contains(key.name) ? number(key) : absent; }

  std::string name() const { return text(kName, std::filesystem::path(path_).stem().string()); }

  SurfaceFilter filter(SurfaceFilter absent) const {
    if (!table_.contains(kFilter)) return absent;
    const std::string wanted = text(kFilter, "");
    for (const fb::SurfaceFilter filter : fb::EnumValuesSurfaceFilter())
      if (wanted == fb::EnumNameSurfaceFilter(filter)) return static_cast<SurfaceFilter>(filter);
    throw InputError(path_, fmt::format("\"{}\" is no texture filter: \"{}\"", kFilter, wanted), "use one of " + filter_names());
  }

 private:
  static bool known(std::string_view key) {
    for (const Key& k : {kUnits, kUpload, kCache, kSupersampling, kRate})
      if (key == k.name) return true;
    return key == kName || key == kFilter;
  }

  static toml::table parse(const std::string& path) {
    try {
      return toml::parse_file(path);
    } catch (const toml::parse_error& error) {
      throw InputError(fmt::format("{}:{}", path, error.source().begin.line), std::string(error.description()),
                       "correct the TOML");
    }
  }

  std::string text(std::string_view key, const std::string& absent) const {
    const toml::node* node = table_.get(key);
    if (!node) return absent;
    if (!node->is_string()) throw InputError(path_, fmt::format("\"{}\" is not a text", key), "write it in quotes");
    return node->as_string()->get();
  }

  int64_t number(const Key& key) const {
    const toml::node* node = table_.get(key.name);
    const int64_t value = node->is_integer() ? node->as_integer()->get() : key.lowest - 1;
    if (value < key.lowest || value > key.highest)
      throw InputError(path_, fmt::format("\"{}\" is not a whole number from {} to {}", key.name, key.lowest, key.highest),
                       "give it one");
    return value;
  }

  std::string path_;
  toml::table table_;
};

Profile read_profile(const std::string& path) {
  const ProfileFile file(path);
  Profile profile;
  profile.name = file.name();
  profile.units_per_frame = static_cast<uint64_t>(file.required(kUnits));
  profile.upload_bytes_per_frame = static_cast<uint64_t>(file.required(kUpload));
  profile.cache_bytes = static_cast<uint64_t>(file.required(kCache));
  profile.supersampling = static_cast<int>(file.optional(kSupersampling, profile.supersampling));
  profile.frames_per_second = static_cast<int>(file.optional(kRate, profile.frames_per_second));
  profile.filter = file.filter(profile.filter);
  return profile;
}

}  // namespace

Profile load_profile(const std::string& name_or_path, const std::string& source) {
  for (const Profile& profile : built_in_profiles())
    if (profile.name == name_or_path) return profile;
  std::error_code error;
  if (!std::filesystem::is_regular_file(name_or_path, error))
    throw InputError(source, "there is no profile \"" + name_or_path + "\"", "use one of " + built_in_names() + ", or the path of a profile file");
  return read_profile(name_or_path);
}

}  // namespace vitrine
