// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/thin_solids.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace vitrine {
namespace {

// Of the primitive's diagonal: about one pixel where it fills half of a small picture.
constexpr float kRodRadius = 1.0f / 250, kPointRadius = 1.0f / 100;
constexpr float kLonePointDiagonal = 1;  // metres, where there is nothing to be thin against

float diagonal_of(const Geometry& g) {
  glm::vec3 low = g.positions[g.indices[0]], high = low;
  for (const uint32_t i : g.indices) {
    low = glm::min(low, g.positions[i]);
    high = glm::max(high, g.positions[i]);
  }
  const float diagonal = glm::length(high - low);
  return diagonal > 0 ? diagonal : kLonePointDiagonal;
}

// The solids made so far: corners with the vertex that they take their attributes from.
struct Solids {
  std::vector<glm::vec3> positions;
  std::vector<uint32_t> sources, indices;

  uint32_t add(const glm::vec3& position, uint32_t source) {
    positions.push_back(position);
    sources.push_back(source);
    return static_cast<uint32_t>(positions.size() - 1);
  }
  void triangle(uint32_t a, uint32_t b, uint32_t c) { indices.insert(indices.end(), {a, b, c}); }
};

template <typename T>
void gather(std::vector<T>& values, const std::vector<uint32_t>& sources) {
  if (values.empty()) return;
  std::vector<T> gathered;
  gathered.reserve(sources.size());
  for (const uint32_t source : sources) gathered.push_back(values[source]);
  values = std::move(gathered);
}

void replace(Geometry& g, Solids solids) {
  g.positions = std::move(solids.positions);
  g.indices = std::move(solids.indices);
  g.normals.clear();
  g.tangents.clear();
  gather(g.texcoords[0], solids.sources);
  gather(g.texcoords[1], solids.sources);
  gather(g.colors, solids.sources);
}

// Two directions that complete `axis` (of unit length) to a right-handed basis.
void complete_basis(const glm::vec3& axis, glm::vec3& u, glm::vec3& v) {
  u = glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.7f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0)));
  v = glm::cross(axis, u);
}

void add_rod(const Geometry& g, uint32_t from, uint32_t to, float radius, Solids& solids) {
  const glm::vec3 a = g.positions[from], b = g.positions[to];
  const float length = glm::length(b - a);
  if (!(length > 0)) return;
  glm::vec3 u, v;
  complete_basis((b - a) / length, u, v);
  uint32_t begin[4], end[4];
  for (int k = 0; k < 4; ++k) {
    const glm::vec3 side = radius * (k % 2 == 0 ? u : v) * (k < 2 ? 1.0f : -1.0f);
    begin[k] = solids.add(a + side, from);
    end[k] = solids.add(b + side, to);
  }
  for (int k = 0; k < 4; ++k) {
    const int next = (k + 1) % 4;
    solids.triangle(begin[k], begin[next], end[next]);
    solids.triangle(begin[k], end[next], end[k]);
  }
  for (int k = 1; k < 3; ++k) {
    solids.triangle(begin[0], begin[k + 1], begin[k]);
    solids.triangle(end[0], end[k], end[k + 1]);
  }
}

void add_octahedron(const Geometry& g, uint32_t point, float radius, Solids& solids) {
  uint32_t tips[6];  // +x -x +y -y +z -z
  for (int t = 0; t < 6; ++t) {
    glm::vec3 tip = g.positions[point];
    tip[t / 2] += t % 2 == 0 ? radius : -radius;
    tips[t] = solids.add(tip, point);
  }
  for (int octant = 0; octant < 8; ++octant) {
    const int x = octant & 1, y = octant >> 1 & 1, z = octant >> 2 & 1;
    const bool mirrored = (x + y + z) % 2 != 0;
    solids.triangle(tips[x], tips[mirrored ? 4 + z : 2 + y], tips[mirrored ? 2 + y : 4 + z]);
  }
}

}  // namespace

void make_rods(Geometry& g) {
  if (g.indices.empty()) return;
  const float radius = kRodRadius * diagonal_of(g);
  Solids solids;
  for (size_t i = 0; i + 1 < g.indices.size(); i += 2) add_rod(g, g.indices[i], g.indices[i + 1], radius, solids);
  replace(g, std::move(solids));
}

void make_octahedra(Geometry& g) {
  if (g.indices.empty()) return;
  const float radius = kPointRadius * diagonal_of(g);
  Solids solids;
  for (const uint32_t point : g.indices) add_octahedron(g, point, radius, solids);
  replace(g, std::move(solids));
}

}  // namespace vitrine
