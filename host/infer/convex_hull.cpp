// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/convex_hull.h"

#include <algorithm>

namespace vitrine {
namespace {

double turn_of(const glm::vec2& a, const glm::vec2& b) {
  return static_cast<double>(a.x) * static_cast<double>(b.y) - static_cast<double>(a.y) * static_cast<double>(b.x);
}

}  // namespace

// Andrew's monotone chain.
std::vector<glm::vec2> convex_hull(std::span<const glm::vec2> from) {
  std::vector<glm::vec2> points(from.begin(), from.end());
  const auto before = [](const glm::vec2& a, const glm::vec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<glm::vec2> hull;
  for (int side = 0; side < 2; ++side) {
    const size_t first = hull.size();
    for (const glm::vec2& p : points) {
      while (hull.size() >= first + 2 && turn_of(hull.back() - hull[hull.size() - 2], p - hull[hull.size() - 2]) <= 0)
        hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();  // the other side begins there
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

}  // namespace vitrine
