// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "host/infer/bit_hash.h"
#include "host/infer/convex_hull.h"
#include "host/infer/uv_raster.h"

namespace vitrine {
namespace {

constexpr float kGrowCosine = 0.6428f;  // 50 degrees: how far a triangle that joins may lean from the chart's mean
constexpr float kKeepCosine = 0.4226f;  // 65 degrees: the same at the end, when the mean has moved
constexpr double kOverlapAllowed = 0.005;

// Vertices at equal positions (bit for bit, -0 is 0) get the same number.
std::vector<uint32_t> weld(std::span<const glm::vec3> positions) {
  std::unordered_map<std::array<uint32_t, 3>, uint32_t, BitHash> numbers;
  std::vector<uint32_t> welded;
  welded.reserve(positions.size());
  for (const glm::vec3& position : positions) {
    const glm::vec3 p = position + 0.0f;
    std::array<uint32_t, 3> key;
    std::memcpy(key.data(), &p, sizeof key);
    welded.push_back(numbers.emplace(key, static_cast<uint32_t>(numbers.size())).first->second);
  }
  return welded;
}

struct Mesh {
  std::span<const glm::vec3> positions;
  std::span<const uint32_t> indices;
  std::vector<glm::vec3> normals;  // length is twice the area
  glm::vec3 corner(uint32_t triangle, size_t k) const { return positions[indices[3 * triangle + k]]; }
};

Mesh make_mesh(std::span<const glm::vec3> positions, std::span<const uint32_t> indices) {
  Mesh mesh{positions, indices, {}};
  for (uint32_t t = 0; t < indices.size() / 3; ++t)
    mesh.normals.push_back(glm::cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0)));
  return mesh;
}

// normal leans less than the angle from direction (neither has unit length). A triangle without area fits everywhere.
bool leans_less(const glm::vec3& normal, const glm::vec3& direction, float cosine) {
  const float product = glm::dot(normal, normal) * glm::dot(direction, direction);
  return product <= 0 || glm::dot(normal, direction) >= cosine * std::sqrt(product);
}

// Grows one chart from `seed`; marks its triangles as assigned.
std::vector<uint32_t> grow(const Mesh& mesh, std::span<const int32_t> neighbors, uint32_t seed, std::vector<uint8_t>& assigned) {
  std::vector<uint32_t> triangles{seed};
  assigned[seed] = 1;
  glm::vec3 mean = mesh.normals[seed];
  for (size_t at = 0; at < triangles.size(); ++at)
    for (size_t k = 0; k < 3; ++k) {
      const int32_t next = neighbors[3 * triangles[at] + k];
      if (next < 0 || assigned[static_cast<size_t>(next)] ||
          !leans_less(mesh.normals[static_cast<size_t>(next)], mean, kGrowCosine))
        continue;
      assigned[static_cast<size_t>(next)] = 1;
      triangles.push_back(static_cast<uint32_t>(next));
      mean += mesh.normals[static_cast<size_t>(next)];
    }
  // The mean moved while the chart grew: what leans too far by now is given back. A seed that does stays alone.
  const bool seed_stays = leans_less(mesh.normals[seed], mean, kKeepCosine);
  const auto given_back = [&](uint32_t t) {
    return t != seed && (!seed_stays || !leans_less(mesh.normals[t], mean, kKeepCosine));
  };
  for (const uint32_t t : triangles) assigned[t] = !given_back(t);
  std::erase_if(triangles, given_back);
  return triangles;
}

struct Frame3 {
  glm::vec3 x, y, z;
};

// An orthonormal frame about the mean normal.
Frame3 frame_of(const Mesh& mesh, std::span<const uint32_t> triangles) {
  glm::vec3 mean(0);
  for (const uint32_t t : triangles) mean += mesh.normals[t];
  const float length = glm::length(mean);
  const glm::vec3 z = length > 0 ? mean / length : glm::vec3(0, 0, 1);
  const glm::vec3 x = glm::normalize(glm::cross(std::fabs(z.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0), z));
  return {x, glm::cross(z, x), z};
}

float cross(const glm::vec2& a, const glm::vec2& b) { return a.x * b.y - a.y * b.x; }

struct Rectangle {
  glm::vec2 axis{1, 0}, low{0}, size{0};
};

Rectangle bounds_along(std::span<const glm::vec2> points, const glm::vec2& axis) {
  const glm::vec2 other{-axis.y, axis.x};
  glm::vec2 low(INFINITY), high(-INFINITY);
  for (const glm::vec2& p : points) {
    const glm::vec2 q{glm::dot(p, axis), glm::dot(p, other)};
    low = glm::min(low, q);
    high = glm::max(high, q);
  }
  return {axis, low, high - low};
}

// One side of the smallest rectangle lies on an edge of the hull (Freeman and Shapira 1975).
Rectangle smallest_rectangle(std::span<const glm::vec2> points) {
  const std::vector<glm::vec2> hull = convex_hull(points);
  Rectangle best = bounds_along(hull, {1, 0});
  const size_t step = std::max<size_t>(1, hull.size() / 256);
  for (size_t i = 0; i < hull.size(); i += step) {
    const glm::vec2 edge = hull[(i + 1) % hull.size()] - hull[i];
    const float length = glm::length(edge);
    if (!(length > 0)) continue;
    const Rectangle candidate = bounds_along(hull, edge / length);
    if (candidate.size.x * candidate.size.y < 0.999f * best.size.x * best.size.y) best = candidate;
  }
  return best;
}

Chart lay_flat(const Mesh& mesh, std::vector<uint32_t> triangles) {
  Chart chart;
  const Frame3 frame = frame_of(mesh, triangles);
  const glm::vec3 origin = mesh.corner(triangles.front(), 0);
  for (const uint32_t t : triangles)
    for (size_t k = 0; k < 3; ++k) {
      const glm::vec3 p = mesh.corner(t, k) - origin;
      chart.corners.emplace_back(glm::dot(p, frame.x), glm::dot(p, frame.y));
    }
  const Rectangle rectangle = smallest_rectangle(chart.corners);
  const bool upright = rectangle.size.y > rectangle.size.x;  // laid down: shelves pack better
  for (glm::vec2& c : chart.corners) {
    const glm::vec2 q = glm::vec2{glm::dot(c, rectangle.axis), cross(rectangle.axis, c)} - rectangle.low;
    c = upright ? glm::vec2{q.y, rectangle.size.x - q.x} : q;
  }
  chart.size = upright ? glm::vec2{rectangle.size.y, rectangle.size.x} : rectangle.size;
  chart.triangles = std::move(triangles);
  return chart;
}

bool overlaps_itself(const Chart& chart) {
  if (chart.triangles.size() < 3) return false;
  const float side = std::max({chart.size.x, chart.size.y, 1e-20f});
  std::vector<glm::vec2> corners;
  corners.reserve(chart.corners.size());
  for (const glm::vec2& c : chart.corners) corners.push_back(c / side);
  const UvCoverage coverage = measure_uv_coverage(corners, chart.triangles.size() < 64 ? 128 : 512);
  return static_cast<double>(coverage.overlapped) > kOverlapAllowed * static_cast<double>(coverage.covered);
}

// Halves the triangles at the median of their centres: along the mean normal first, where the turns of a spiral part, then
// along the frame's other axes.
std::array<std::vector<uint32_t>, 2> halve(const Mesh& mesh, std::vector<uint32_t> triangles, int depth) {
  const Frame3 frame = frame_of(mesh, triangles);
  const glm::vec3 axis = depth % 3 == 0 ? frame.z : depth % 3 == 1 ? frame.x : frame.y;
  const auto height = [&](uint32_t t) { return glm::dot(axis, mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)); };
  std::stable_sort(triangles.begin(), triangles.end(), [&](uint32_t a, uint32_t b) { return height(a) < height(b); });
  const auto middle = triangles.begin() + static_cast<ptrdiff_t>(triangles.size() / 2);
  return {std::vector<uint32_t>(triangles.begin(), middle), std::vector<uint32_t>(middle, triangles.end())};
}

void add_charts(const Mesh& mesh, std::vector<uint32_t> triangles, int depth, std::vector<Chart>& charts) {
  Chart chart = lay_flat(mesh, std::move(triangles));
  if (!overlaps_itself(chart)) {
    charts.push_back(std::move(chart));
    return;
  }
  for (auto& half : halve(mesh, std::move(chart.triangles), depth)) add_charts(mesh, std::move(half), depth + 1, charts);
}

// Largest first: big flat parts become charts of their own, what is left over stays small.
std::vector<uint32_t> seeds_by_area(const Mesh& mesh) {
  std::vector<uint32_t> order(mesh.normals.size());
  std::iota(order.begin(), order.end(), 0u);
  std::vector<float> areas;
  for (const glm::vec3& n : mesh.normals) areas.push_back(glm::dot(n, n));
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return areas[a] > areas[b]; });
  return order;
}

}  // namespace

std::vector<int32_t> edge_neighbors(std::span<const glm::vec3> positions, std::span<const uint32_t> indices) {
  const std::vector<uint32_t> welded = weld(positions);
  struct Edge {
    uint32_t low, high, slot;
  };
  std::vector<Edge> edges;
  for (uint32_t slot = 0; slot < indices.size(); ++slot) {
    const uint32_t a = welded[indices[slot]], b = welded[indices[slot % 3 == 2 ? slot - 2 : slot + 1]];
    if (a != b) edges.push_back({std::min(a, b), std::max(a, b), slot});
  }
  std::sort(edges.begin(), edges.end(),
            [](const Edge& a, const Edge& b) { return std::tie(a.low, a.high, a.slot) < std::tie(b.low, b.high, b.slot); });
  std::vector<int32_t> neighbors(indices.size(), -1);
  for (size_t i = 0; i + 1 < edges.size(); ++i)
    if (edges[i].low == edges[i + 1].low && edges[i].high == edges[i + 1].high) {
      neighbors[edges[i].slot] = static_cast<int32_t>(edges[i + 1].slot / 3);
      neighbors[edges[i + 1].slot] = static_cast<int32_t>(edges[i].slot / 3);
      ++i;
    }
  return neighbors;
}

std::optional<std::vector<Chart>> make_charts(std::span<const glm::vec3> positions, std::span<const uint32_t> indices,
                                              std::span<const int32_t> neighbors, size_t max_charts) {
  const Mesh mesh = make_mesh(positions, indices);
  std::vector<uint8_t> assigned(mesh.normals.size());
  std::vector<Chart> charts;
  std::vector<uint32_t> seeds = seeds_by_area(mesh);
  while (!seeds.empty()) {  // triangles that were given back become seeds in the next round
    for (const uint32_t seed : seeds) {
      if (assigned[seed]) continue;
      add_charts(mesh, grow(mesh, neighbors, seed, assigned), 0, charts);
      if (charts.size() > max_charts) return std::nullopt;
    }
    std::erase_if(seeds, [&](uint32_t t) { return assigned[t] != 0; });
  }
  return charts;
}

}  // namespace vitrine
