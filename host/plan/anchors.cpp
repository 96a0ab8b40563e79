// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/plan/anchors.h"

#include <cmath>

namespace vitrine {

AnchorLattice::AnchorLattice(const ParameterSpace& space, const std::vector<float>& max_speed, bool interpolate) : space_(space) {
  for (int a = 0; a < space.axis_count; ++a) {
    const AxisShape& axis = space.axes[a];
    const bool between = interpolate && axis.kind != AxisKind::kDiscrete && axis.samples > 1;
    displayed_[a] = between ? 2 : 1;
    cells_[a] = between && axis.kind == AxisKind::kLinear ? axis.samples - 1 : axis.samples;
    speed_[a] = axis.kind == AxisKind::kDiscrete || axis.samples == 1 ? 0 : max_speed[static_cast<size_t>(a)];
  }
}

int64_t AnchorLattice::cell_count() const {
  int64_t count = 1;
  for (int a = 0; a < space_.axis_count; ++a) count *= cells_[a];
  return count;
}

// A position that has just reached the far border of its cell is already at the next sample's demand region, so that the
// next sample is within reach of any horizon.
int AnchorLattice::reach(int axis, int horizon) const {
  return moves(axis) ? static_cast<int>(std::floor(speed_[axis] * horizon + 1e-6)) + 1 : 0;
}

IntervalSet AnchorLattice::samples(int axis, int cell, int reach) const {
  const int n = space_.axes[axis].samples, first = cell - reach, last = cell + displayed_[axis] - 1 + reach;
  IntervalSet set;
  if (!wraps(axis)) {
    set.add(std::max(first, 0), std::min(last, n - 1));
  } else if (last - first + 1 >= n) {
    set.add(0, n - 1);
  } else {
    if (last >= n) set.add(0, last - n);
    set.add(std::max(first, 0), std::min(last, n - 1));
    if (first < 0) set.add(first + n, n - 1);
  }
  return set;
}

}  // namespace vitrine
