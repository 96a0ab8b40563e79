// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/chart_packing.h"

#include <stb/stb_rect_pack.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace vitrine {
namespace {

constexpr int kGrid = 2048;          // units along a side while packing
constexpr float kGrowth = 1.04f;     // the square grows by this until all fit
constexpr float kPairInset = 0.12f;  // of a cell, on each side

// Units between a chart and its cell. Two charts are twice that apart: 4 texels at 512 x 512 where there are few.
int gutter_units(size_t charts) { return charts <= 64 ? kGrid / 256 : charts <= 512 ? kGrid / 512 : kGrid / 1024; }

float side_lower_bound(std::span<const Chart> charts) {
  double area = 0;
  float longest = 0;
  for (const Chart& chart : charts) {
    area += static_cast<double>(chart.size.x) * static_cast<double>(chart.size.y);
    longest = std::max({longest, chart.size.x, chart.size.y});
  }
  return std::max({static_cast<float>(std::sqrt(area)), longest, 1e-20f}) * 1.02f;
}

bool try_pack(std::span<const Chart> charts, float side, int gutter, std::vector<stbrp_rect>& rects,
              std::vector<stbrp_node>& nodes) {
  for (size_t i = 0; i < charts.size(); ++i) {
    const auto units = [&](float length) { return static_cast<int>(std::ceil(length / side * kGrid)) + 2 * gutter; };
    rects[i] = {static_cast<int>(i), units(charts[i].size.x), units(charts[i].size.y), 0, 0, 0};
  }
  stbrp_context context;
  stbrp_init_target(&context, kGrid, kGrid, nodes.data(), static_cast<int>(nodes.size()));
  return stbrp_pack_rects(&context, rects.data(), static_cast<int>(rects.size())) != 0;
}

}  // namespace

std::vector<glm::vec2> pack_charts(std::span<const Chart> charts, size_t triangle_count) {
  std::vector<stbrp_rect> rects(charts.size());
  std::vector<stbrp_node> nodes(kGrid);
  const int gutter = gutter_units(charts.size());
  float side = side_lower_bound(charts);
  while (!try_pack(charts, side, gutter, rects, nodes)) side *= kGrowth;
  std::vector<glm::vec2> corners(3 * triangle_count);
  for (size_t i = 0; i < charts.size(); ++i) {
    const glm::vec2 origin{static_cast<float>(rects[i].x + gutter) / kGrid, static_cast<float>(rects[i].y + gutter) / kGrid};
    for (size_t t = 0; t < charts[i].triangles.size(); ++t)
      for (size_t k = 0; k < 3; ++k) corners[3 * charts[i].triangles[t] + k] = origin + charts[i].corners[3 * t + k] / side;
  }
  return corners;
}

std::vector<glm::vec2> pack_pairs(std::span<const uint32_t> indices, std::span<const int32_t> neighbors) {
  const size_t triangles = indices.size() / 3;
  constexpr uint32_t kNone = UINT32_MAX;
  struct Place {
    uint32_t cell = kNone;
    uint32_t shared_edge = 0;  // edge k to k + 1 is the cell's diagonal
    bool upper = false;
  };
  std::vector<Place> places(triangles);
  uint32_t cells = 0;
  for (uint32_t t = 0; t < triangles; ++t) {
    if (places[t].cell != kNone) continue;
    places[t].cell = cells++;
    for (uint32_t k = 0; k < 3; ++k) {
      const int32_t n = neighbors[3 * t + k];
      if (n < 0 || static_cast<uint32_t>(n) == t || places[static_cast<size_t>(n)].cell != kNone) continue;
      places[t].shared_edge = k;
      Place& other = places[static_cast<size_t>(n)];
      other = {places[t].cell, 0, true};
      while (other.shared_edge < 2 && neighbors[3 * static_cast<size_t>(n) + other.shared_edge] != static_cast<int32_t>(t))
        ++other.shared_edge;
      break;
    }
  }
  const auto side = static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(std::max(1u, cells)))));
  std::vector<glm::vec2> corners(indices.size());
  for (uint32_t t = 0; t < triangles; ++t) {
    const Place& place = places[t];
    // Lower: diagonal from (1, 0) to (0, 1), third corner (0, 0). The neighbour walks the shared edge the other way.
    const std::array<glm::vec2, 3> lower{{{1, 0}, {0, 1}, {0, 0}}}, upper{{{0, 1}, {1, 0}, {1, 1}}};
    for (uint32_t k = 0; k < 3; ++k) {
      const glm::vec2 in_cell =
          kPairInset + (1 - 2 * kPairInset) * (place.upper ? upper : lower)[(k + 3 - place.shared_edge) % 3];
      corners[3 * t + k] = (glm::vec2(place.cell % side, place.cell / side) + in_cell) / static_cast<float>(side);
    }
  }
  return corners;
}

}  // namespace vitrine
