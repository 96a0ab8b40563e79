// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/parameter_space.h"

#include <algorithm>
#include <cmath>

namespace vitrine {
namespace {

float clamp01(float x) { return x >= 0 ? std::min(x, 1.0f) : 0.0f; }  // NaN becomes 0

}  // namespace

int64_t ParameterSpace::sample_count() const {
  int64_t count = 1;
  for (int a = 0; a < axis_count; ++a) count *= axes[a].samples;
  return count;
}

int64_t ParameterSpace::flat_from_index(const GridIndex& index) const {
  int64_t flat = 0;
  for (int a = 0; a < axis_count; ++a) flat = flat * axes[a].samples + index[a];
  return flat;
}

GridIndex ParameterSpace::index_from_flat(int64_t flat) const {
  GridIndex index{};
  for (int a = axis_count - 1; a >= 0; --a) {
    index[a] = static_cast<int>(flat % axes[a].samples);
    flat /= axes[a].samples;
  }
  return index;
}

Position ParameterSpace::position_of(const GridIndex& index) const {
  Position position{};
  for (int a = 0; a < axis_count; ++a) {
    const int n = axes[a].samples;
    const int intervals = axes[a].kind == AxisKind::kPeriodic ? n : std::max(1, n - 1);
    position[a] = static_cast<float>(index[a]) / static_cast<float>(intervals);
  }
  return position;
}

float ParameterSpace::sample_coordinate(int axis, float position) const {
  const int n = axes[axis].samples;
  const float p = clamp01(position);
  if (axes[axis].kind != AxisKind::kPeriodic) return p * static_cast<float>(n - 1);
  const float c = p * static_cast<float>(n);
  return c >= static_cast<float>(n) ? c - static_cast<float>(n) : c;
}

GridIndex ParameterSpace::nearest_sample(const Position& position) const {
  GridIndex index{};
  for (int a = 0; a < axis_count; ++a) {
    const int n = axes[a].samples;
    index[a] = static_cast<int>(sample_coordinate(a, position[a]) + 0.5f) % n;
  }
  return index;
}

ParameterSpace ParameterSpace::restricted(AxisMask mask) const {
  ParameterSpace space = *this;
  for (int a = 0; a < axis_count; ++a)
    if (!(mask >> a & 1)) space.axes[a].samples = 1;
  return space;
}

int corners_around(const ParameterSpace& space, const Position& position, std::array<Corner, kMaxCorners>& out) {
  out[0] = Corner{GridIndex{}, 1.0f};
  int count = 1;
  for (int a = 0; a < space.axis_count; ++a) {
    const int n = space.axes[a].samples;
    const float c = space.sample_coordinate(a, position[a]);
    int low = static_cast<int>(c);
    float t = c - static_cast<float>(low);
    if (space.axes[a].kind == AxisKind::kDiscrete) {
      low = static_cast<int>(c + 0.5f);
      t = 0;
    }
    const int high = space.axes[a].kind == AxisKind::kPeriodic ? (low + 1) % n : std::min(low + 1, n - 1);
    if (high == low) t = 0;
    const int before = count;
    for (int i = 0; i < before; ++i) {
      out[i].index[a] = low;
      if (t <= 0) continue;
      out[count] = out[i];
      out[count].index[a] = high;
      out[count++].weight *= t;
      out[i].weight *= 1 - t;
    }
  }
  std::sort(out.begin(), out.begin() + count,
            [&](const Corner& a, const Corner& b) { return space.flat_from_index(a.index) < space.flat_from_index(b.index); });
  return count;
}

}  // namespace vitrine
