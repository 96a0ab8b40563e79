// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How many camera rays each pixel gets. What a surface scatters diffusely is the same from everywhere, and inference averages
// it over all views; what it reflects or refracts is seen once, so pixels that may show it get more rays. One ray through
// each pixel's centre, spread over its neighbours, decides: nothing that is averaged later, so means stay unbiased.
#pragma once

#include <cstdint>
#include <vector>

#include "host/trace/camera_rays.h"
#include "host/trace/integrator.h"

namespace vitrine::trace {

class RayCounts {
 public:
  // `base`: rays of a pixel that shows nothing specular; `factor` >= 1: times as many where it does, and four times that
  // where nearly all light is specular.
  RayCounts(const Integrator& integrator, const CameraRays& camera, int width, int height, int base, int factor);
  int at(int x, int y) const { return counts_[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)]; }

 private:
  int width_;
  std::vector<int> counts_;
};

}  // namespace vitrine::trace
