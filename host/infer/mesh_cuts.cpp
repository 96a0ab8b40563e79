// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/mesh_cuts.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <set>
#include <tuple>

#include "host/base/mesh_grid.h"
#include "host/infer/vertex_table.h"

namespace vitrine {
namespace {

struct Line {
  int dimension;  // 0: u = at, 1: v = at
  float at;
};

// All of each line is cut, and u first everywhere: where two triangles share an edge, both cut it at the same points.
std::vector<Line> lines_between(std::span<const DomainPart> patches) {
  std::vector<Line> lines;
  for (int dimension = 0; dimension < 2; ++dimension) {
    std::set<int> at;
    for (const DomainPart& patch : patches) at.insert(patch.low[dimension]);
    for (const int line : at)
      if (line > 0) lines.push_back({dimension, static_cast<float>(line) / VisibleSurface::kCoarseCells});
  }
  return lines;
}

using Triangle = std::array<MeshVertex, 3>;

float coordinate(const MeshVertex& vertex, int dimension) { return dimension == 0 ? vertex.u : vertex.v; }

// Where the line meets the edge; the same whichever end comes first.
MeshVertex meeting(MeshVertex a, MeshVertex b, const Line& line) {
  const auto key = [](const MeshVertex& v) { return std::tie(v.x, v.y, v.z, v.u, v.v); };
  if (key(b) < key(a)) std::swap(a, b);
  const float from = coordinate(a, line.dimension), t = (line.at - from) / (coordinate(b, line.dimension) - from);
  const auto mix = [t](float p, float q) { return p + t * (q - p); };
  MeshVertex vertex{mix(a.x, b.x), mix(a.y, b.y), mix(a.z, b.z), mix(a.u, b.u), mix(a.v, b.v)};
  (line.dimension == 0 ? vertex.u : vertex.v) = line.at;
  return vertex;
}

// The part of the triangle on one side of the line, as a fan.
void add_side(const Triangle& triangle, const Line& line, bool above, std::vector<Triangle>& out) {
  const auto inside = [&](const MeshVertex& v) {
    return above ? coordinate(v, line.dimension) >= line.at : coordinate(v, line.dimension) <= line.at;
  };
  const auto beyond = [&](const MeshVertex& v) { return !inside(v); };
  std::vector<MeshVertex> polygon;
  for (size_t k = 0; k < 3; ++k) {
    const MeshVertex &from = triangle[k], &to = triangle[(k + 1) % 3];
    if (inside(from)) polygon.push_back(from);
    const bool on = coordinate(from, line.dimension) == line.at || coordinate(to, line.dimension) == line.at;
    if (!on && inside(from) == beyond(to)) polygon.push_back(meeting(from, to, line));
  }
  for (size_t k = 2; k < polygon.size(); ++k) out.push_back({polygon[0], polygon[k - 1], polygon[k]});
}

std::vector<Triangle> cut(const Triangle& whole, std::span<const Line> lines) {
  std::vector<Triangle> pieces{whole};
  for (const Line& line : lines) {
    std::vector<Triangle> next;
    for (const Triangle& piece : pieces) {
      const auto [low, high] = std::minmax(
          {coordinate(piece[0], line.dimension), coordinate(piece[1], line.dimension), coordinate(piece[2], line.dimension)});
      if (low >= line.at || high <= line.at) {
        next.push_back(piece);
        continue;
      }
      add_side(piece, line, false, next);
      add_side(piece, line, true, next);
    }
    pieces = std::move(next);
  }
  return pieces;
}

// The patch that holds the triangle's centre.
size_t patch_of(const Triangle& triangle, std::span<const DomainPart> patches) {
  const glm::vec2 sum(triangle[0].u + triangle[1].u + triangle[2].u, triangle[0].v + triangle[1].v + triangle[2].v);
  const glm::ivec2 cell =
      glm::clamp(glm::ivec2(sum / 3.0f * float{VisibleSurface::kCoarseCells}), 0, VisibleSurface::kCoarseCells - 1);
  for (size_t k = 0; k < patches.size(); ++k)
    if (cell.x >= patches[k].low.x && cell.x < patches[k].high.x && cell.y >= patches[k].low.y && cell.y < patches[k].high.y)
      return k;
  return 0;
}

}  // namespace

DrawnObject cut_into_patches(const DrawnObject& object, std::span<const DomainPart> patches) {
  const std::vector<Line> lines = lines_between(patches);
  DrawnObject result;
  result.object = object.object;
  result.grid = object.grid;
  VertexTable table;
  for (size_t i = 0; i < object.indices.size(); i += 3) {
    if (i == object.culled_index_count) result.culled_index_count = static_cast<uint32_t>(result.indices.size());
    Triangle whole;
    for (size_t k = 0; k < 3; ++k) whole[k] = object.vertices[object.indices[i + k]];
    for (Triangle piece : cut(whole, lines)) {
      const auto raise = kPatchStep * static_cast<float>(patch_of(piece, patches));
      result.triangles.push_back(object.triangles[i / 3]);
      for (MeshVertex& vertex : piece) {
        vertex = laid_on_grid(object.grid, vertex);
        vertex.u += raise;
        result.indices.push_back(table.index_of(vertex, result.vertices));
      }
    }
  }
  if (object.culled_index_count == object.indices.size())
    result.culled_index_count = static_cast<uint32_t>(result.indices.size());
  return result;
}

}  // namespace vitrine
