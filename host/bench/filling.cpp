// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/filling.h"

#include <algorithm>
#include <cmath>

namespace vitrine {
namespace {

constexpr int kNone = -1;

// Of each column: the row of the nearest defined pixel, kNone where there is none.
std::vector<int> nearest_in_columns(const PartialPicture& p) {
  std::vector<int> rows(p.values.size(), kNone);
  const auto at = [&](int x, int y) { return static_cast<size_t>(y) * static_cast<size_t>(p.width) + static_cast<size_t>(x); };
  for (int x = 0; x < p.width; ++x) {
    for (int y = 0; y < p.height; ++y) rows[at(x, y)] = p.defined[at(x, y)] ? y : y > 0 ? rows[at(x, y - 1)] : kNone;
    for (int y = p.height - 2; y >= 0; --y) {
      const int above = rows[at(x, y)], below = rows[at(x, y + 1)];
      if (below != kNone && (above == kNone || std::abs(below - y) < std::abs(above - y))) rows[at(x, y)] = below;
    }
  }
  return rows;
}

struct Pixel {
  int x = 0, y = 0;
};

// By walking away along the row as long as something nearer may come. (0, 0)'s own if nothing is defined at all.
Pixel nearest_defined(const PartialPicture& p, const std::vector<int>& rows, const Pixel& from) {
  Pixel best;
  int64_t distance = INT64_MAX;
  for (int step = 0; step < p.width && static_cast<int64_t>(step) * step < distance; ++step)
    for (const int x : {from.x - step, from.x + step}) {
      if (x < 0 || x >= p.width) continue;
      const int y = rows[static_cast<size_t>(from.y) * static_cast<size_t>(p.width) + static_cast<size_t>(x)];
      if (y == kNone) continue;
      const int64_t d = static_cast<int64_t>(step) * step + static_cast<int64_t>(y - from.y) * (y - from.y);
      if (d < distance) distance = d, best = {x, y};
    }
  return best;
}

PartialPicture half(const PartialPicture& fine) {
  PartialPicture coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}, {}};
  for (int y = 0; y < coarse.height; ++y)
    for (int x = 0; x < coarse.width; ++x) {
      glm::vec3 sum(0);
      int count = 0;
      for (int v = 2 * y; v < std::min(2 * y + 2, fine.height); ++v)
        for (int u = 2 * x; u < std::min(2 * x + 2, fine.width); ++u) {
          const size_t i = static_cast<size_t>(v) * static_cast<size_t>(fine.width) + static_cast<size_t>(u);
          if (!fine.defined[i]) continue;
          sum += fine.values[i];
          ++count;
        }
      coarse.values.push_back(count ? sum / static_cast<float>(count) : sum);
      coarse.defined.push_back(count > 0);
    }
  return coarse;
}

// Bilinear, cell centres at (x + 1/2), clamped.
glm::vec3 interpolate(const std::vector<glm::vec3>& values, int width, int height, float x, float y) {
  const float cx = std::clamp(x - 0.5f, 0.0f, static_cast<float>(width - 1)),
              cy = std::clamp(y - 0.5f, 0.0f, static_cast<float>(height - 1));
  const int x0 = static_cast<int>(cx), y0 = static_cast<int>(cy);
  const int x1 = std::min(x0 + 1, width - 1), y1 = std::min(y0 + 1, height - 1);
  const auto at = [&](int u, int v) {
    return values[static_cast<size_t>(v) * static_cast<size_t>(width) + static_cast<size_t>(u)];
  };
  const float s = cx - static_cast<float>(x0), t = cy - static_cast<float>(y0);
  return (1 - t) * ((1 - s) * at(x0, y0) + s * at(x1, y0)) + t * ((1 - s) * at(x0, y1) + s * at(x1, y1));
}

bool all_defined(const PartialPicture& p) {
  return std::all_of(p.defined.begin(), p.defined.end(), [](uint8_t d) { return d != 0; });
}

}  // namespace

std::vector<glm::vec3> fill_by_reflection(const PartialPicture& p) {
  if (std::none_of(p.defined.begin(), p.defined.end(), [](uint8_t d) { return d != 0; })) return p.values;
  const std::vector<int> rows = nearest_in_columns(p);
  std::vector<glm::vec3> filled = p.values;
  const auto at = [&](int x, int y) { return static_cast<size_t>(y) * static_cast<size_t>(p.width) + static_cast<size_t>(x); };
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      if (p.defined[at(x, y)]) continue;
      const Pixel edge = nearest_defined(p, rows, {x, y});
      const int u = 2 * edge.x - x, v = 2 * edge.y - y;
      const bool mirrored = u >= 0 && v >= 0 && u < p.width && v < p.height && p.defined[at(u, v)];
      filled[at(x, y)] = mirrored ? p.values[at(u, v)] : p.values[at(edge.x, edge.y)];
    }
  return filled;
}

std::vector<glm::vec3> fill_from_neighbors(const PartialPicture& p) {
  if (all_defined(p) || (p.width <= 1 && p.height <= 1)) return p.values;
  const PartialPicture coarse = half(p);
  const std::vector<glm::vec3> coarser = fill_from_neighbors(coarse);
  std::vector<glm::vec3> filled = p.values;
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x) {
      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(p.width) + static_cast<size_t>(x);
      if (p.defined[i]) continue;
      filled[i] = interpolate(coarser, coarse.width, coarse.height, 0.5f * (static_cast<float>(x) + 0.5f),
                              0.5f * (static_cast<float>(y) + 0.5f));
    }
  return filled;
}

}  // namespace vitrine
