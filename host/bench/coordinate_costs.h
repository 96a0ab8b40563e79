// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How many texels an object needs with fitted texture coordinates (Hakura 2001, section 3.2), and how many for the same quality
// with its mesh's own.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/base/progress.h"
#include "host/frames/store.h"
#include "host/scene/scene.h"

namespace vitrine {

struct TexelPoint {
  double texels = 0;   // of all the object's layers, one sample
  double psnr_db = 0;  // over the object's pixels at the samples, 8-bit sRGB
};

struct CoordinateCost {
  std::string object;
  bool artists = false;  // the mesh's own coordinates are the artist's; else they are charts (host/infer/parameterization.h)
  std::vector<TexelPoint> fitted, whole, square;  // at growing resolutions
  TexelPoint compared;                            // fitted, at the scene's own resolution
  // Of `whole` and `square` for the PSNR of `compared`, between their points; none: not reached within them.
  std::optional<double> whole_needs, square_needs;
};

// Over `views` samples, one block, in the middle of the axis that moves the camera (host/bench/frozen_scene.h).
std::vector<CoordinateCost> measure_coordinates(const Scene& scene, int views, int samples_per_pixel, const Store& store,
                                                Progress& progress);

}  // namespace vitrine
