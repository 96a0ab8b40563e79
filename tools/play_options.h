// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The command line of vitrine-play.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include "formats/image.h"
#include "tools/usage_error.h"

namespace vitrine {

// What the user should read: "FILE: what is wrong: what to do".
struct PlayError : std::runtime_error {
  PlayError(const std::string& file, const std::string& what, const std::string& remedy)
      : std::runtime_error(file + ": " + what + ": " + remedy) {}
};

enum class Backend { kSdl, kOsmesa, kNull };

// Frames that are played off screen where neither --frames nor a script says how many.
inline constexpr int64_t kFramesWithoutEnd = 60;

struct PlayOptions {
  std::string image;
  std::optional<Backend> backend;  // absent: as the machine and the other options suggest
  std::string at, script, out;
  std::optional<int64_t> frames;
  bool stats = false, json = false, quiet = false, full_screen = false;
  bool still() const { return out.ends_with(".png"); }
};

// Absent: --help or --version was asked for and answered. Throws UsageError.
std::optional<PlayOptions> parse_options(int argc, char** argv);
Backend backend_of(const PlayOptions& options);

// "view=0.5,lamp=0.2", "view=#17"; axes that are not named stay at 0. Throws UsageError.
Position parse_position(const std::string& text, const ImageView& image);
std::string axis_name(const ImageView& image, int axis);

}  // namespace vitrine
