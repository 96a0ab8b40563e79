// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/frames/store.h"

#include <system_error>

#include "host/base/error.h"
#include "host/frames/exr.h"
#include "host/frames/sealed_file.h"

namespace vitrine {
namespace {

constexpr int kCombinedTag = -1;
constexpr size_t kMaxName = 200;  // OpenEXR names end at 255 bytes

std::filesystem::path path_of(const std::filesystem::path& directory, const char* kind, const StoreKey& key) {
  const std::string hex = key.hex();
  return directory / kind / hex.substr(0, 2) / (hex + ".exr");
}
std::filesystem::path scratch_of(const std::filesystem::path& directory) { return directory / "scratch"; }

// Three channels PREFIX + R, G, B from pixels, and back.
void append_color(const std::string& prefix, const std::vector<glm::vec3>& pixels, ExrPart& part) {
  const char* const names[] = {"R", "G", "B"};
  for (int c = 0; c < 3; ++c) {
    ExrChannel channel{prefix + names[c], std::vector<float>(pixels.size())};
    for (size_t i = 0; i < pixels.size(); ++i) channel.values[i] = pixels[i][c];
    part.channels.push_back(std::move(channel));
  }
}
std::vector<glm::vec3> color_from(const ExrPart& part, size_t first) {
  const auto& r = part.channels[first].values;
  const auto& g = part.channels[first + 1].values;
  const auto& b = part.channels[first + 2].values;
  std::vector<glm::vec3> pixels(r.size());
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = {r[i], g[i], b[i]};
  return pixels;
}

// Names are labels for people and other programs; reading goes by tag and channel order.
ExrPart part_from_object(const ObjectFrame& object, const Scene& scene) {
  const std::string name = scene.objects[static_cast<size_t>(object.object)].name.substr(0, kMaxName);
  // The index keeps cut names, and an object that is called "combined", apart.
  const bool taken = name == "combined" || name.size() == kMaxName || name.empty();
  const std::string label = taken ? name + "#" + std::to_string(object.object) : name;
  ExrPart part{label, object.object, object.x, object.y, object.width, object.height, {}};
  append_color(label + ".diffuse.", object.diffuse, part);
  append_color(label + ".specular.", object.specular, part);
  part.channels.push_back({label + ".coverage.Y", object.coverage});
  return part;
}

std::optional<ObjectFrame> object_from_part(const ExrPart& part, size_t object_count) {
  if (part.tag < 0 || static_cast<size_t>(part.tag) >= object_count || part.channels.size() != 7) return {};
  ObjectFrame object{part.tag, part.x, part.y, part.width, part.height, {}, {}, {}};
  object.diffuse = color_from(part, 0);
  object.specular = color_from(part, 3);
  object.coverage = part.channels[6].values;
  return object;
}

void check_planes(const LayeredImage& image) {
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  bool good = image.width > 0 && image.height > 0 && !image.planes.empty();
  for (const auto& plane : image.planes) good = good && plane.values.size() == pixels && !plane.name.empty();
  if (!good) throw std::invalid_argument("planes to store must have one size, at least 1 x 1, and names");
}

}  // namespace

Store::Store(std::filesystem::path directory) : directory_(std::move(directory)) {
  std::error_code error;
  for (const char* folder : {"frames", "textures", "scratch"}) {
    std::filesystem::create_directories(directory_ / folder, error);
    if (error || !std::filesystem::is_directory(directory_ / folder)) {
      throw InputError(directory_.string(), "cannot hold the work (" + (error ? error.message() : "a file is in the way") + ")",
                       "choose another folder with --work");
    }
  }
  clean_scratch(scratch_of(directory_));
}

bool Store::has_frame(const StoreKey& key) const { return has_sealed(path_of(directory_, "frames", key)); }

std::string exr_of_frame(const Scene& scene, const Frame& frame) {
  ExrFile file{frame.width, frame.height, {}};
  ExrPart combined{"combined", kCombinedTag, 0, 0, frame.width, frame.height, {}};
  append_color("", frame.combined, combined);
  file.parts.push_back(std::move(combined));
  for (const ObjectFrame& object : frame.objects) {
    if (object.width > 0 && object.height > 0) file.parts.push_back(part_from_object(object, scene));
  }
  return encode_exr(file);
}

void Store::save_frame(const StoreKey& key, const Scene& scene, const Frame& frame) const {
  write_sealed(path_of(directory_, "frames", key), scratch_of(directory_), exr_of_frame(scene, frame));
}

std::optional<Frame> Store::load_frame(const StoreKey& key, const Scene& scene) const {
  const auto bytes = read_sealed(path_of(directory_, "frames", key));
  const auto file = bytes ? decode_exr(*bytes) : std::nullopt;
  if (!file) return {};
  const ExrPart& combined = file->parts[0];
  if (combined.tag != kCombinedTag || combined.channels.size() != 3) return {};
  if (combined.width != file->width || combined.height != file->height) return {};
  Frame frame{file->width, file->height, color_from(combined, 0), {}};
  for (size_t p = 1; p < file->parts.size(); ++p) {
    auto object = object_from_part(file->parts[p], scene.objects.size());
    if (!object || (!frame.objects.empty() && frame.objects.back().object >= object->object)) return {};
    frame.objects.push_back(std::move(*object));
  }
  return frame;
}

bool Store::has_planes(const StoreKey& key) const { return has_sealed(path_of(directory_, "textures", key)); }

void Store::save_planes(const StoreKey& key, const LayeredImage& image) const {
  check_planes(image);
  ExrPart part{"planes", kCombinedTag, 0, 0, image.width, image.height, {}};
  for (const auto& plane : image.planes) part.channels.push_back({plane.name, plane.values});
  write_sealed(path_of(directory_, "textures", key), scratch_of(directory_), encode_exr({image.width, image.height, {part}}));
}

std::optional<LayeredImage> Store::load_planes(const StoreKey& key) const {
  const auto bytes = read_sealed(path_of(directory_, "textures", key));
  auto file = bytes ? decode_exr(*bytes) : std::nullopt;
  if (!file || file->parts.size() != 1) return {};
  ExrPart& part = file->parts[0];
  if (part.x != 0 || part.y != 0) return {};
  LayeredImage image{part.width, part.height, {}};
  for (ExrChannel& channel : part.channels) image.planes.push_back({std::move(channel.name), std::move(channel.values)});
  return image;
}

}  // namespace vitrine
