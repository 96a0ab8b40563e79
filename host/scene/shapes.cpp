// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/shapes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "host/scene/environment.h"

namespace vitrine {
namespace {

void add_triangle(Geometry& g, uint32_t a, uint32_t b, uint32_t c) { g.indices.insert(g.indices.end(), {a, b, c}); }

// Exact at the poles and at the seam, where sine and cosine are not.
glm::vec3 grid_direction(int i, int j, int columns, int rows) {
  if (j == 0 || j == rows) return {0, j == 0 ? 1.0f : -1.0f, 0};
  return direction_from_latlong(
      {static_cast<float>(i % columns) / static_cast<float>(columns), static_cast<float>(j) / static_cast<float>(rows)});
}

}  // namespace

Geometry make_sphere(float radius, int columns, int rows) {
  Geometry g;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const glm::vec3 d = grid_direction(i, j, columns, rows);
      // A pole's vertex lies between the meridians of its triangle: i and i + 1 at the top, i - 1 and i at the bottom.
      const float shift = j == 0 ? 0.5f : j == rows ? -0.5f : 0.0f;
      g.positions.push_back(radius * d);
      g.normals.push_back(d);
      g.texcoords[0].emplace_back(std::clamp((static_cast<float>(i) + shift) / static_cast<float>(columns), 0.0f, 1.0f),
                                  static_cast<float>(j) / static_cast<float>(rows));
    }
  // Seen from outside, u grows to the right and v downwards.
  const uint32_t stride = static_cast<uint32_t>(columns) + 1;
  for (uint32_t j = 0; j < static_cast<uint32_t>(rows); ++j)
    for (uint32_t i = 0; i < static_cast<uint32_t>(columns); ++i) {
      const uint32_t a = j * stride + i, b = a + 1, c = a + stride, d = c + 1;
      if (j + 1 < static_cast<uint32_t>(rows)) add_triangle(g, a, d, c);
      if (j > 0) add_triangle(g, a, b, d);
    }
  // The last vertex of the top row and the first of the bottom row belong to no triangle; they are harmless.
  return g;
}

Geometry make_dome(float radius, int columns, int rows) {
  Geometry g = make_sphere(radius, columns, rows);
  for (size_t i = 0; i < g.indices.size(); i += 3) std::swap(g.indices[i + 1], g.indices[i + 2]);
  for (glm::vec3& n : g.normals) n = -n;
  return g;
}

float dome_inner_radius(int columns, int rows) {
  constexpr float kPi = std::numbers::pi_v<float>;
  return std::cos(kPi / static_cast<float>(columns)) * std::cos(kPi / static_cast<float>(2 * rows));
}

Geometry make_box(const glm::vec3& size) {
  Geometry g;
  int cell = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-0.5f, 0.5f}) {
      glm::vec3 n(0), u(0), v(0);
      n[axis] = side * 2;
      u[(axis + 1) % 3] = side * 2;
      v[(axis + 2) % 3] = 1;
      const uint32_t first = static_cast<uint32_t>(g.positions.size());
      for (const glm::vec2 corner : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
        g.positions.push_back((0.5f * n + (corner.x - 0.5f) * u + (corner.y - 0.5f) * v) * size);
        g.normals.push_back(n);
        g.texcoords[0].push_back((glm::vec2(cell % 3, cell / 3) + 0.04f + 0.92f * glm::vec2(corner.x, 1 - corner.y)) /
                                 glm::vec2(3, 2));
      }
      add_triangle(g, first, first + 1, first + 2);
      add_triangle(g, first, first + 2, first + 3);
      ++cell;
    }
  return g;
}

}  // namespace vitrine
