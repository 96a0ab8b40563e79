// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Importance sampling of the pixel filter of formats/pixel_filter.h (Ernst et al., "Filter Importance Sampling", 2006): every
// sample of a pixel then weighs 1, and coverages and layers are plain means over samples.
#pragma once

#include <glm/vec2.hpp>
#include <vector>

namespace vitrine::trace {

class FilterSampler {
 public:
  FilterSampler();
  // Offset from the pixel's centre, in pixels, distributed as the filter.
  glm::vec2 sample(const glm::vec2& u) const { return {invert(u.x), invert(u.y)}; }

 private:
  float invert(float u) const;
  std::vector<float> quantiles_;  // offsets at equally spaced probabilities
};

}  // namespace vitrine::trace
