// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Places charts side by side in the unit square, all at one scale, with gutters between them.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "host/infer/charts.h"

namespace vitrine {

// Texture coordinates in [0, 1]^2, three per triangle, triangle by triangle in the mesh's order.
std::vector<glm::vec2> pack_charts(std::span<const Chart> charts, size_t triangle_count);

// For meshes that are mere noise: triangles in pairs over a shared edge, every pair in a cell of its own of a regular
// grid. Sizes are not kept; nothing overlaps and every triangle gets its share.
std::vector<glm::vec2> pack_pairs(std::span<const uint32_t> indices, std::span<const int32_t> neighbors);

}  // namespace vitrine
