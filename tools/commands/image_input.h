// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Images as the subcommands read them, and the scenes that they were compiled from.
#pragma once

#include <memory>
#include <string>

#include "formats/image.h"
#include "hal/storage.h"
#include "host/scene/scene.h"
#include "tools/commands/commands.h"

namespace vitrine {

// Mapped and checked. Throws InputError. From here on a damaged medium ends the program with a line (explain_bus_errors).
class OpenImage {
 public:
  explicit OpenImage(const std::string& path);
  const ImageView& view() const { return view_; }

 private:
  hal::MappedFile file_;
  ImageView view_;
};

// The scene with the grid of the image. Throws InputError where it has not the image's objects; warns on stderr (unless quiet)
// where it has changed.
std::unique_ptr<const Scene> load_scene_of(const ImageView& image, const std::string& image_path, const std::string& scene_path,
                                           const CommonOptions& options);

}  // namespace vitrine
