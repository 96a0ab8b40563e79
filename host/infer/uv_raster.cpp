// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/uv_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace vitrine {
namespace {

constexpr int kSubcells = 64;  // corners are rounded to 1/64 of a cell, so that edge functions are exact integers

struct Point {
  int64_t x = 0, y = 0;
};

Point snap(const glm::vec2& corner, int size) {
  const auto along = [&](float t) { return std::llround(std::clamp(static_cast<double>(t), 0.0, 1.0) * size * kSubcells); };
  return {along(corner.x), along(corner.y)};
}

int64_t cross(const Point& a, const Point& b, const Point& p) { return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x); }

// The top-left rule for counter-clockwise triangles.
bool inside_edge(const Point& a, const Point& b, const Point& p) {
  const int64_t side = cross(a, b, p);
  return side > 0 || (side == 0 && (b.y < a.y || (b.y == a.y && b.x > a.x)));
}

int first_cell(int64_t a, int64_t b, int64_t c) { return static_cast<int>(std::min({a, b, c}) / kSubcells); }
int last_cell(int64_t a, int64_t b, int64_t c, int size) {
  return std::min(size - 1, static_cast<int>(std::max({a, b, c}) / kSubcells));
}

void count_triangle(std::array<Point, 3> p, int size, std::vector<uint8_t>& counts) {
  const int64_t area = cross(p[0], p[1], p[2]);
  if (area == 0) return;
  if (area < 0) std::swap(p[1], p[2]);
  const int y1 = last_cell(p[0].y, p[1].y, p[2].y, size), x1 = last_cell(p[0].x, p[1].x, p[2].x, size);
  for (int y = first_cell(p[0].y, p[1].y, p[2].y); y <= y1; ++y)
    for (int x = first_cell(p[0].x, p[1].x, p[2].x); x <= x1; ++x) {
      const Point center{x * kSubcells + kSubcells / 2, y * kSubcells + kSubcells / 2};
      if (!inside_edge(p[0], p[1], center) || !inside_edge(p[1], p[2], center) || !inside_edge(p[2], p[0], center)) continue;
      uint8_t& count = counts[static_cast<size_t>(y) * static_cast<size_t>(size) + static_cast<size_t>(x)];
      if (count < 2) ++count;
    }
}

}  // namespace

UvCoverage measure_uv_coverage(std::span<const glm::vec2> corners, int size) {
  std::vector<uint8_t> counts(static_cast<size_t>(size) * static_cast<size_t>(size));
  for (size_t t = 0; t + 2 < corners.size(); t += 3)
    count_triangle({snap(corners[t], size), snap(corners[t + 1], size), snap(corners[t + 2], size)}, size, counts);
  UvCoverage coverage;
  for (const uint8_t count : counts) {
    coverage.covered += count > 0;
    coverage.overlapped += count > 1;
  }
  return coverage;
}

}  // namespace vitrine
