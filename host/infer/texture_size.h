// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Which part of an object's texture domain is ever seen, and how many texels it deserves (Hakura 2001, section 3.2), both
// read off renderings of identifiers.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "host/infer/test_renderer.h"

namespace vitrine {

// What all states together show of one object.
class ObjectSurvey {
 public:
  bool visible() const { return low_.x <= high_.x; }
  glm::vec2 low() const { return low_; }
  glm::vec2 high() const { return high_; }
  // Output pixels that a whole unit of u (v) covers; 90 % of the visible pixels have less.
  glm::vec2 pixels_per_unit() const;

  void include(const glm::vec2& uv);
  void count(const glm::vec2& pixels_per_unit);
  void merge(const ObjectSurvey& other);

 private:
  static constexpr size_t kBins = 640;
  glm::vec2 low_{1e30f}, high_{-1e30f};
  std::array<std::array<int64_t, kBins>, 2> histograms_{};  // over the logarithm, 16 bins an octave
};

// Per object of the renderer.
std::vector<ObjectSurvey> survey_objects(TestRenderer& renderer, size_t object_count, int supersampling,
                                         std::span<const GeometryState> states);

// Sets the texture size and maps the part that is seen, with a margin of two texels, to [0, 1]^2. `texels_per_pixel`
// already holds the object's resolution scale. Sizes are multiples of 8 in [8, max_size].
void fit_texture(DrawnObject& object, const ObjectSurvey& survey, float texels_per_pixel, int max_size);

}  // namespace vitrine
