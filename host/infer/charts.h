// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Cuts a mesh into charts that can be laid flat: triangles grow over shared edges while their normals stay near the
// chart's mean, and are projected along it.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

namespace vitrine {

struct Chart {
  std::vector<uint32_t> triangles;
  std::vector<glm::vec2> corners;  // 3 per triangle, in the units of the positions; the smallest rectangle begins at 0
  glm::vec2 size{0};               // of that rectangle
};

// Triangles that share an edge, by position (vertices at equal positions are one). Per triangle edge (k to k + 1) another
// triangle or -1; where more than two meet, they are linked in pairs.
std::vector<int32_t> edge_neighbors(std::span<const glm::vec3> positions, std::span<const uint32_t> indices);

// Charts that together hold every triangle once and do not overlap themselves; nothing if there would be more than
// `max_charts`.
std::optional<std::vector<Chart>> make_charts(std::span<const glm::vec3> positions, std::span<const uint32_t> indices,
                                              std::span<const int32_t> neighbors, size_t max_charts);

}  // namespace vitrine
