// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/geometry.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace vitrine {
namespace {

// Cross product of two edges in double precision: twice the area, along the outward normal.
glm::dvec3 area_normal(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
}

glm::dvec3 area_normal(const Geometry& g, size_t triangle) {
  const uint32_t* i = &g.indices[3 * triangle];
  return area_normal(g.positions[i[0]], g.positions[i[1]], g.positions[i[2]]);
}

// Thinner than float can tell: area below 1e-10 of the longest edge squared.
bool is_degenerate(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const double area = glm::length(area_normal(a, b, c));
  const glm::dvec3 e0 = glm::dvec3(b) - glm::dvec3(a), e1 = glm::dvec3(c) - glm::dvec3(b), e2 = glm::dvec3(a) - glm::dvec3(c);
  const double longest = std::max({glm::dot(e0, e0), glm::dot(e1, e1), glm::dot(e2, e2)});
  return !(area > 1e-10 * longest) || area < 1e-60;
}

template <typename T>
void gather(std::vector<T>& values, const std::vector<uint32_t>& sources) {
  if (values.empty()) return;
  std::vector<T> gathered(sources.size());
  for (size_t i = 0; i < sources.size(); ++i) gathered[i] = values[sources[i]];
  values = std::move(gathered);
}

void gather_vertices(Geometry& g, const std::vector<uint32_t>& sources) {
  gather(g.positions, sources);
  gather(g.normals, sources);
  gather(g.tangents, sources);
  gather(g.texcoords[0], sources);
  gather(g.texcoords[1], sources);
  gather(g.colors, sources);
}

template <typename T>
void append(std::vector<T>& to, size_t to_count, const std::vector<T>& from, size_t from_count, T filler) {
  if (to.empty() && from.empty()) return;
  to.resize(to_count, filler);
  if (from.empty())
    to.resize(to_count + from_count, filler);
  else
    to.insert(to.end(), from.begin(), from.end());
}

// ---- Tangents

// One corner of a triangle as MikkTSpace sees it.
struct TangentCorner {
  uint32_t vertex;
  uint32_t corner;  // index into Geometry::indices
  bool mirrored;
  glm::vec3 tangent;  // times the corner's angle; zero where the texture has no area
};

glm::vec3 face_tangent(const Geometry& g, const std::vector<glm::vec2>& uv, const uint32_t* i, bool* mirrored) {
  const glm::vec3 e1 = g.positions[i[1]] - g.positions[i[0]], e2 = g.positions[i[2]] - g.positions[i[0]];
  const glm::vec2 d1 = uv[i[1]] - uv[i[0]], d2 = uv[i[2]] - uv[i[0]];
  const float area = d1.x * d2.y - d2.x * d1.y;
  *mirrored = area > 0;  // v points down: an upright picture on a counter-clockwise triangle has negative area
  const glm::vec3 t = (e1 * d2.y - e2 * d1.y) * (area > 0 ? 1.0f : -1.0f);
  const float length = glm::length(t);
  return area == 0 || !(length > 0) || !std::isfinite(length) ? glm::vec3(0) : t / length;
}

glm::vec3 project(const glm::vec3& v, const glm::vec3& normal) { return v - normal * glm::dot(normal, v); }

glm::vec3 unit_or_zero(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 1e-20f && std::isfinite(length) ? v / length : glm::vec3(0);
}

float corner_angle(const Geometry& g, const uint32_t* i, int c, const glm::vec3& normal) {
  const glm::vec3& p = g.positions[i[c]];
  const glm::vec3 a = unit_or_zero(project(g.positions[i[(c + 1) % 3]] - p, normal));
  const glm::vec3 b = unit_or_zero(project(g.positions[i[(c + 2) % 3]] - p, normal));
  return std::acos(std::clamp(glm::dot(a, b), -1.0f, 1.0f));
}

std::vector<TangentCorner> corners_of(const Geometry& g, const std::vector<glm::vec2>& uv) {
  std::vector<TangentCorner> corners;
  corners.reserve(g.indices.size());
  for (size_t first = 0; first < g.indices.size(); first += 3) {
    const uint32_t* i = &g.indices[first];
    bool mirrored = false;
    const glm::vec3 tangent = face_tangent(g, uv, i, &mirrored);
    for (int c = 0; c < 3; ++c) {
      const glm::vec3& n = g.normals[i[c]];
      corners.push_back({i[c], static_cast<uint32_t>(first) + static_cast<uint32_t>(c), mirrored,
                         unit_or_zero(project(tangent, n)) * corner_angle(g, i, c, n)});
    }
  }
  return corners;
}

// Compares what MikkTSpace welds: position, normal, texture coordinates, handedness.
struct WeldOrder {
  const Geometry& g;
  const std::vector<glm::vec2>& uv;
  int compare(const TangentCorner& a, const TangentCorner& b) const {
    const glm::vec3 &pa = g.positions[a.vertex], &pb = g.positions[b.vertex], &na = g.normals[a.vertex],
                    &nb = g.normals[b.vertex];
    for (int c = 0; c < 3; ++c)
      if (pa[c] != pb[c]) return pa[c] < pb[c] ? -1 : 1;
    for (int c = 0; c < 3; ++c)
      if (na[c] != nb[c]) return na[c] < nb[c] ? -1 : 1;
    for (int c = 0; c < 2; ++c)
      if (uv[a.vertex][c] != uv[b.vertex][c]) return uv[a.vertex][c] < uv[b.vertex][c] ? -1 : 1;
    return static_cast<int>(a.mirrored) - static_cast<int>(b.mirrored);
  }
  bool operator()(const TangentCorner& a, const TangentCorner& b) const {
    const int order = compare(a, b);
    if (order != 0) return order < 0;
    return a.vertex != b.vertex ? a.vertex < b.vertex : a.corner < b.corner;
  }
};

glm::vec4 group_tangent(const glm::vec3& sum, const glm::vec3& normal, bool mirrored) {
  glm::vec3 t = unit_or_zero(project(sum, normal));
  if (t == glm::vec3(0))  // no texture area at all: any direction in the surface
    t = glm::normalize(glm::cross(normal, std::abs(normal.x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0)));
  return {t, mirrored ? -1.0f : 1.0f};
}

}  // namespace

size_t drop_degenerate_triangles(Geometry& g) {
  size_t kept = 0;
  for (size_t i = 0; i < g.indices.size(); i += 3) {
    const uint32_t a = g.indices[i], b = g.indices[i + 1], c = g.indices[i + 2];
    if (is_degenerate(g.positions[a], g.positions[b], g.positions[c])) continue;
    g.indices[kept] = a;
    g.indices[kept + 1] = b;
    g.indices[kept + 2] = c;
    kept += 3;
  }
  const size_t dropped = (g.indices.size() - kept) / 3;
  g.indices.resize(kept);
  return dropped;
}

void make_flat_normals(Geometry& g) {
  const std::vector<uint32_t> sources = g.indices;
  g.normals.clear();
  g.tangents.clear();  // glTF 2.0, section 3.7.2.1: meaningless without the file's normals
  gather_vertices(g, sources);
  for (size_t i = 0; i < g.indices.size(); ++i) g.indices[i] = static_cast<uint32_t>(i);
  g.normals.resize(g.positions.size());
  for (size_t t = 0; t < g.indices.size() / 3; ++t) {
    const glm::vec3 normal(glm::normalize(area_normal(g, t)));
    for (size_t c = 0; c < 3; ++c) g.normals[3 * t + c] = normal;
  }
}

void repair_normals(Geometry& g) {
  bool missing = false;
  for (glm::vec3& n : g.normals) {
    n = unit_or_zero(n);
    missing |= n == glm::vec3(0);
  }
  if (!missing) return;
  std::vector<glm::dvec3> sums(g.positions.size(), glm::dvec3(0));
  for (size_t t = 0; t < g.indices.size() / 3; ++t) {
    const glm::dvec3 normal = area_normal(g, t);
    for (size_t c = 0; c < 3; ++c) sums[g.indices[3 * t + c]] += normal;
  }
  for (size_t i = 0; i < g.normals.size(); ++i) {
    if (g.normals[i] != glm::vec3(0)) continue;
    const double length = glm::length(sums[i]);
    g.normals[i] = length > 0 ? glm::vec3(sums[i] / length) : glm::vec3(0, 1, 0);
  }
}

void make_tangents(Geometry& g, int texcoord, const glm::mat3& transform) {
  std::vector<glm::vec2> uv(g.positions.size(), glm::vec2(0));
  const std::vector<glm::vec2>& given = g.texcoords[static_cast<size_t>(texcoord)];
  for (size_t i = 0; i < given.size(); ++i) uv[i] = glm::vec2(transform * glm::vec3(given[i], 1));
  std::vector<TangentCorner> corners = corners_of(g, uv);
  const WeldOrder order{g, uv};
  std::sort(corners.begin(), corners.end(), order);

  // Sum each group; give its tangent to its vertices, doubling those that already carry another group's.
  std::vector<uint32_t> sources(g.positions.size());
  for (size_t i = 0; i < sources.size(); ++i) sources[i] = static_cast<uint32_t>(i);
  g.tangents.assign(g.positions.size(), glm::vec4(0));
  for (size_t first = 0, last = 0; first < corners.size(); first = last) {
    glm::vec3 sum(0);
    for (last = first; last < corners.size() && order.compare(corners[first], corners[last]) == 0; ++last)
      sum += corners[last].tangent;
    const glm::vec4 tangent = group_tangent(sum, g.normals[corners[first].vertex], corners[first].mirrored);
    uint32_t vertex = UINT32_MAX, target = 0;
    for (size_t k = first; k < last; ++k) {
      if (corners[k].vertex != vertex) {
        target = vertex = corners[k].vertex;
        if (g.tangents[vertex].w != 0) {
          target = static_cast<uint32_t>(sources.size());
          sources.push_back(vertex);
          g.tangents.push_back(tangent);
        }
        g.tangents[target] = tangent;
      }
      g.indices[corners[k].corner] = target;
    }
  }
  for (glm::vec4& t : g.tangents)
    if (t.w == 0) t = {1, 0, 0, 1};  // vertices that no triangle uses
  std::vector<glm::vec4> tangents = std::move(g.tangents);
  g.tangents.clear();
  gather_vertices(g, sources);
  g.tangents = std::move(tangents);
}

void append_geometry(Geometry& g, const Geometry& more) {
  const size_t before = g.positions.size(), added = more.positions.size();
  append(g.positions, before, more.positions, added, glm::vec3(0));
  append(g.normals, before, more.normals, added, glm::vec3(0, 1, 0));
  append(g.tangents, before, more.tangents, added, glm::vec4(1, 0, 0, 1));
  append(g.texcoords[0], before, more.texcoords[0], added, glm::vec2(0));
  append(g.texcoords[1], before, more.texcoords[1], added, glm::vec2(0));
  append(g.colors, before, more.colors, added, glm::vec4(1));
  for (const uint32_t i : more.indices) g.indices.push_back(i + static_cast<uint32_t>(before));
  g.triangle_materials.insert(g.triangle_materials.end(), more.triangle_materials.begin(), more.triangle_materials.end());
}

}  // namespace vitrine
