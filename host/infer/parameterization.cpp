// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/base/mesh_grid.h"
#include "host/infer/parameterization.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "host/infer/chart_packing.h"
#include "host/infer/charts.h"
#include "host/infer/uv_raster.h"
#include "host/infer/vertex_table.h"

namespace vitrine {
namespace {

constexpr float kDomainMargin = 1e-4f;
constexpr int kOverlapGrid = 1024;
constexpr double kOverlapAllowed = 0.01, kCrampedAllowed = 0.05, kCrampedDensity = 1.0 / 400;

std::vector<glm::vec3> world_positions(const Geometry& geometry, const glm::mat4& world_from_object) {
  std::vector<glm::vec3> positions;
  positions.reserve(geometry.positions.size());
  for (const glm::vec3& p : geometry.positions) positions.emplace_back(world_from_object * glm::vec4(p, 1));
  return positions;
}

bool inside_domain(std::span<const glm::vec2> coordinates) {
  return std::all_of(coordinates.begin(), coordinates.end(), [](const glm::vec2& c) {  // false for NaN as well
    return c.x >= -kDomainMargin && c.x <= 1 + kDomainMargin && c.y >= -kDomainMargin && c.y <= 1 + kDomainMargin;
  });
}

std::vector<glm::vec2> corners_of(const Geometry& geometry) {
  std::vector<glm::vec2> corners;
  corners.reserve(geometry.indices.size());
  for (const uint32_t index : geometry.indices) corners.push_back(geometry.texcoords[0][index]);
  return corners;
}

// Share of the surface on triangles that get far too little of the texture.
double cramped_share(std::span<const glm::vec3> positions, std::span<const uint32_t> indices,
                     std::span<const glm::vec2> corners) {
  std::vector<double> surface, texture;
  double surface_sum = 0, texture_sum = 0, cramped = 0;
  for (size_t t = 0; t + 2 < indices.size(); t += 3) {
    const glm::vec3 a = positions[indices[t]], b = positions[indices[t + 1]], c = positions[indices[t + 2]];
    const glm::vec2 p = corners[t + 1] - corners[t], q = corners[t + 2] - corners[t];
    surface.push_back(static_cast<double>(glm::length(glm::cross(b - a, c - a))));
    texture.push_back(
        std::fabs(static_cast<double>(p.x) * static_cast<double>(q.y) - static_cast<double>(p.y) * static_cast<double>(q.x)));
    surface_sum += surface.back();
    texture_sum += texture.back();
  }
  if (!(surface_sum > 0) || !(texture_sum > 0)) return 1;
  for (size_t t = 0; t < surface.size(); ++t)
    if (texture[t] < kCrampedDensity * texture_sum / surface_sum * surface[t]) cramped += surface[t];
  return cramped / surface_sum;
}

bool is_single_sided(const Material& material) { return !material.double_sided && !(material.transmission > 0); }

bool is_culled(const Scene& scene, const Object& object, size_t triangle) {
  const auto single = [&](const std::vector<int>& materials) {
    return triangle >= materials.size() || materials[triangle] < 0 ||
           is_single_sided(scene.materials[static_cast<size_t>(materials[triangle])]);
  };
  return single(object.geometry.triangle_materials) &&
         std::all_of(object.variant_materials.begin(), object.variant_materials.end(),
                     [&](const auto& materials) { return materials.empty() || single(materials); });
}

}  // namespace

bool is_proper_parameterization(const Geometry& geometry, const glm::mat4& world_from_object) {
  if (geometry.indices.empty() || geometry.texcoords[0].size() != geometry.positions.size()) return false;
  const std::vector<glm::vec2> corners = corners_of(geometry);
  if (!inside_domain(corners)) return false;
  if (cramped_share(world_positions(geometry, world_from_object), geometry.indices, corners) > kCrampedAllowed) return false;
  const UvCoverage coverage = measure_uv_coverage(corners, kOverlapGrid);
  return coverage.covered > 0 &&
         static_cast<double>(coverage.overlapped) < kOverlapAllowed * static_cast<double>(coverage.covered);
}

std::vector<glm::vec2> texture_domain(const Geometry& geometry, const glm::mat4& world_from_object) {
  if (is_proper_parameterization(geometry, world_from_object)) {
    std::vector<glm::vec2> corners = corners_of(geometry);
    for (glm::vec2& corner : corners) corner = glm::clamp(corner, 0.0f, 1.0f);
    return corners;
  }
  const std::vector<glm::vec3> positions = world_positions(geometry, world_from_object);
  const std::vector<int32_t> neighbors = edge_neighbors(positions, geometry.indices);
  if (const auto charts = make_charts(positions, geometry.indices, neighbors, kMaxCharts))
    return pack_charts(*charts, geometry.indices.size() / 3);
  return pack_pairs(geometry.indices, neighbors);
}

DrawnObject make_drawn_object(const Scene& scene, int object_index, const glm::mat4& world_from_object) {
  const Object& object = scene.objects[static_cast<size_t>(object_index)];
  const std::vector<glm::vec2> corners = texture_domain(object.geometry, world_from_object);
  DrawnObject drawn;
  drawn.object = object_index;
  VertexTable table;
  const auto add = [&](bool culled) {
    for (size_t t = 0; 3 * t + 2 < object.geometry.indices.size(); ++t) {
      if (is_culled(scene, object, t) != culled) continue;
      drawn.triangles.push_back(static_cast<uint32_t>(t));
      for (size_t i = 3 * t; i < 3 * t + 3; ++i) {
        const glm::vec3& p = object.geometry.positions[object.geometry.indices[i]];
        drawn.indices.push_back(table.index_of({p.x, p.y, p.z, corners[i].x, corners[i].y}, drawn.vertices));
      }
    }
  };
  add(true);
  drawn.culled_index_count = static_cast<uint32_t>(drawn.indices.size());
  add(false);
  drawn.grid = lay_on_grid(drawn.vertices);
  return drawn;
}

}  // namespace vitrine
