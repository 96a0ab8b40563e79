// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Presets: how much of what the scene asks for a compile spends. An artist iterates with `tiny`, shows with `small` and
// ships with `full`.
#pragma once

#include <string>

#include "host/scene/scene.h"

namespace vitrine {

// name   resolution  samples per axis              noise             storage
// full   as written  as written                    as written        as written
// small  half        half (at least 2)             9 dB more        as written
// tiny   a quarter   at most 3                     18 dB more, at    what `full` would get
//                                                  most 8 rays a pixel
// Discrete axes keep all their values. Throws InputError for another name.
void apply_preset(Scene& scene, const std::string& name);

// Makes the scene agree with an image that was compiled from it: its resolution, paths per pixel and samples per axis. Throws InputError when
// the image's axes are not the scene's.
struct GridOfImage {
  int width = 0, height = 0, paths_per_pixel = 0;
  float noise_db = 0;
  std::vector<std::pair<std::string, int>> axes;  // name, samples
};
void apply_grid(Scene& scene, const GridOfImage& grid, const std::string& image_name);

}  // namespace vitrine
