// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/base/mesh_grid.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace vitrine {
namespace {

constexpr float kSteps = 65535;
// Of the distance from the node's origin: with finer steps single precision could not tell places apart.
constexpr float kLeastStep = 0x1p-22f;

uint16_t nearest_step(float value, float steps) { return static_cast<uint16_t>(std::clamp(std::round(value), 0.0f, steps)); }

}  // namespace

MeshGrid grid_over(std::span<const MeshVertex> vertices) {
  if (vertices.empty()) return {};
  glm::vec3 low(vertices[0].x, vertices[0].y, vertices[0].z), high = low;
  for (const MeshVertex& v : vertices) {
    low = glm::min(low, glm::vec3(v.x, v.y, v.z));
    high = glm::max(high, glm::vec3(v.x, v.y, v.z));
  }
  const glm::vec3 extent = high - low, far = glm::max(glm::abs(low), glm::abs(high));
  const float step = std::max(std::max({extent.x, extent.y, extent.z}) / kSteps, std::max({far.x, far.y, far.z}) * kLeastStep);
  return {low, step > 0 ? step : 1};
}

GridVertex nearest_on_grid(const MeshGrid& grid, const MeshVertex& vertex) {
  const int patch = TextureMap::patch_of(vertex.u);
  return {nearest_step((vertex.x - grid.origin.x) / grid.step, kSteps),
          nearest_step((vertex.y - grid.origin.y) / grid.step, kSteps),
          nearest_step((vertex.z - grid.origin.z) / grid.step, kSteps),
          static_cast<uint16_t>(patch),
          nearest_step((vertex.u - kPatchStep * static_cast<float>(patch)) * kTextureSteps, kTextureSteps),
          nearest_step(vertex.v * kTextureSteps, kTextureSteps)};
}

MeshVertex laid_on_grid(const MeshGrid& grid, const MeshVertex& vertex) {
  return vertex_on_grid(grid, nearest_on_grid(grid, vertex));
}

MeshGrid lay_on_grid(std::span<MeshVertex> vertices) {
  const MeshGrid grid = grid_over(vertices);
  for (MeshVertex& vertex : vertices) vertex = laid_on_grid(grid, vertex);
  return grid;
}

}  // namespace vitrine
