// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/surface_points.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vitrine {
namespace {

constexpr double kEdge = -1e-6;  // weight from which a cell's centre on an edge counts as covered

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

struct CellRange {
  int first, last;
};
CellRange cells_between(double low, double high, int size) {
  const auto limit = static_cast<double>(size);
  return {static_cast<int>(std::floor(std::clamp(low - 0.5, 0.0, limit))),
          static_cast<int>(std::clamp(std::ceil(high), -1.0, limit - 1))};
}

glm::vec3 corner_position(const MeshVertex& v) { return {v.x, v.y, v.z}; }

// Corners of one triangle in units of cells.
using CellTriangle = std::array<glm::dvec2, 3>;

bool is_torn(const std::array<const MeshVertex*, 3>& vertex, const TextureMap& map) {
  const int patch = TextureMap::patch_of(vertex[0]->u);
  const glm::vec2 cut = map.patches[static_cast<size_t>(patch)].cut + glm::vec2(kPatchStep * static_cast<float>(patch), 0);
  const auto parts = [&](float MeshVertex::*coordinate, float at) {
    const bool first = vertex[0]->*coordinate < at;
    return (vertex[1]->*coordinate < at) != first || (vertex[2]->*coordinate < at) != first;
  };
  return parts(&MeshVertex::u, cut.x) || parts(&MeshVertex::v, cut.y);
}

void fill_triangle(const DrawnObject& object, int triangle, const Placement& placement, std::vector<SurfacePoint>& points) {
  const auto [width, height] = placement.size;
  std::array<const MeshVertex*, 3> vertex;
  CellTriangle p;
  for (size_t k = 0; k < 3; ++k) {
    vertex[k] = &object.vertices[object.indices[3 * static_cast<size_t>(triangle) + k]];
    p[k] = glm::dvec2(placement.map({vertex[k]->u, vertex[k]->v})) * glm::dvec2(width, height);
  }
  if (is_torn(vertex, placement.map)) return;
  const double area = cross(p[1] - p[0], p[2] - p[0]);
  if (area == 0) return;
  const auto [x0, x1] = cells_between(std::min({p[0].x, p[1].x, p[2].x}), std::max({p[0].x, p[1].x, p[2].x}), width);
  const auto [y0, y1] = cells_between(std::min({p[0].y, p[1].y, p[2].y}), std::max({p[0].y, p[1].y, p[2].y}), height);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      SurfacePoint& point = points[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
      const glm::dvec2 center(x + 0.5, y + 0.5);
      const double b = cross(center - p[0], p[2] - p[0]) / area, c = cross(p[1] - p[0], center - p[0]) / area;
      if (point.triangle >= 0 || b < kEdge || c < kEdge || 1 - b - c < kEdge) continue;
      point.triangle = triangle;
      point.weights = {1 - b - c, b, c};
      for (int k = 0; k < 3; ++k) point.position += point.weights[k] * corner_position(*vertex[static_cast<size_t>(k)]);
    }
}

}  // namespace

std::vector<SurfacePoint> surface_points(const DrawnObject& object, const Placement& placement) {
  std::vector<SurfacePoint> points(static_cast<size_t>(placement.size.width) * static_cast<size_t>(placement.size.height));
  for (size_t t = 0; 3 * t < object.indices.size(); ++t) fill_triangle(object, static_cast<int>(t), placement, points);
  return points;
}

std::optional<glm::vec2> pixel_of(const glm::mat4& clip_from_object, const glm::vec3& position, const glm::vec2& size) {
  const glm::vec4 clip = clip_from_object * glm::vec4(position, 1);
  if (!(clip.w > 0)) return std::nullopt;
  return glm::vec2(0.5f + 0.5f * clip.x / clip.w, 0.5f - 0.5f * clip.y / clip.w) * size;
}

}  // namespace vitrine
