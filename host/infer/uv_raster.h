// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How often triangles in the plane cover the cells of a grid: the test whether a texture domain overlaps itself.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>

namespace vitrine {

struct UvCoverage {
  int64_t covered = 0;     // cells whose centre lies in a triangle
  int64_t overlapped = 0;  // in two or more
};

// `corners`: three per triangle in [0, 1]^2 (clamped), of either orientation. A centre on an edge that two triangles share
// belongs to one of them only, so a mesh without overlap counts none. `size` <= 4096 cells a side.
UvCoverage measure_uv_coverage(std::span<const glm::vec2> corners, int size);

}  // namespace vitrine
