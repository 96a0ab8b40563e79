// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/verify/positions.h"

#include <algorithm>
#include <cmath>

namespace vitrine {
namespace {

// The generalized golden ratio's powers: a low-discrepancy sequence in kMaxAxes dimensions (Roberts 2018, "The unreasonable
// effectiveness of quasirandom sequences"; the root of x^5 = x + 1).
constexpr double kRoot = 1.1673039782614187;

double spread(int i, int axis) {
  const double x = 0.5 + (i + 1) / std::pow(kRoot, axis + 1);
  return x - std::floor(x);
}

GridIndex sample_number(const ParameterSpace& space, int i) {
  GridIndex index{};
  for (int a = 0; a < space.axis_count; ++a)
    index[a] = std::min(space.axes[a].samples - 1, static_cast<int>(spread(i, a) * space.axes[a].samples));
  return index;
}

// `index` moved by a fraction of a sample along an axis, back inside where it lies at the end of a linear one.
float moved(const ParameterSpace& space, const GridIndex& index, int axis, float fraction) {
  const AxisShape& shape = space.axes[axis];
  const float at = space.position_of(index)[axis];
  if (shape.kind == AxisKind::kDiscrete || shape.samples == 1) return at;
  if (shape.kind == AxisKind::kPeriodic) return at + fraction / static_cast<float>(shape.samples);
  const float step = fraction / static_cast<float>(shape.samples - 1);
  return index[axis] == shape.samples - 1 ? at - step : at + step;
}

}  // namespace

std::vector<Position> positions_at(const ParameterSpace& space, int count) {
  std::vector<Position> positions;
  for (int i = 0; i < count; ++i) positions.push_back(space.position_of(sample_number(space, i)));
  return positions;
}

std::vector<Position> positions_between(const ParameterSpace& space, int count) {
  std::vector<Position> positions;
  for (int i = 0; i < count; ++i) {
    const GridIndex index = sample_number(space, i);
    Position position = space.position_of(index);
    if (space.axis_count > 0) position[i % space.axis_count] = moved(space, index, i % space.axis_count, 0.5f);
    positions.push_back(position);
  }
  return positions;
}

std::vector<Position> positions_off(const ParameterSpace& space, int count) {
  std::vector<Position> positions;
  for (int i = 0; i < count; ++i) {
    const GridIndex index = sample_number(space, i);
    Position position = space.position_of(index);
    for (int a = 0; a < space.axis_count; ++a) position[a] = moved(space, index, a, 0.2f + 0.3f * static_cast<float>(spread(i, a)));
    positions.push_back(position);
  }
  return positions;
}

}  // namespace vitrine
