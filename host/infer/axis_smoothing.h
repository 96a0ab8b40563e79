// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Textures of neighbouring samples drawn towards each other where the picture does not say otherwise. Within a block a texel is
// the same point of the surface in every sample, so what one sample leaves undetermined (a texel that something hides, or that
// it sees at a grazing angle) takes what its neighbours know, and what differs by noise alone differs less: both cost the coder
// bits and show between samples.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "formats/block.h"

namespace vitrine {

// A texture, or a part of one. Its precision (TextureSolver::precision) is an upper bound of what the picture determines, so
// that smoothing gives way to the picture.
struct SolvedTexture {
  std::vector<glm::vec3> texels;
  std::vector<float> precision;
  // Holds each texel where it is beside its precision: what no pixel sees keeps what inference filled in. Where inference saw
  // nothing of a texture it had nothing to fill in from.
  float hold = kHold;
  static constexpr float kHold = 1e-4f, kHoldUnseen = 1e-12f;
};

// Minimizes, texel by texel, over the samples s of a box of the grid
//   sum_s (precision_s + hold_s) |x_s - inferred_s|^2 + strength * sum over neighbours s, t of |x_s - x_t|^2.
// `textures`: row-major over `box`, all of one size. Samples next to each other along a discrete axis are no neighbours.
void smooth_over_axes(const ParameterSpace& space, const FieldShape::Box& box, float strength,
                      std::vector<SolvedTexture>& textures);

}  // namespace vitrine
