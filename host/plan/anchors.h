// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The lattice of anchors: the cells of the parameter space within which the displayed samples do not change, and the samples
// that must be resident while the position is in a cell.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/parameter_space.h"
#include "host/plan/intervals.h"

namespace vitrine {

class AnchorLattice {
 public:
  // `max_speed`: samples per frame, one per axis. With `interpolate` a cell lies between two samples of a linear or periodic
  // axis and shows both; else it is what is nearest to one sample.
  AnchorLattice(const ParameterSpace& space, const std::vector<float>& max_speed, bool interpolate);

  int axis_count() const { return space_.axis_count; }
  int cells(int axis) const { return cells_[axis]; }
  int64_t cell_count() const;
  bool wraps(int axis) const { return space_.axes[axis].kind == AxisKind::kPeriodic; }
  // Discrete axes and those of one cell move by jumps only.
  bool moves(int axis) const { return speed_[axis] > 0; }
  double speed(int axis) const { return speed_[axis]; }  // samples per frame, 0 where it does not move

  // How many samples beyond the displayed ones can come to be displayed within `horizon` frames of being in a cell.
  int reach(int axis, int horizon) const;
  // The samples within `reach` of those that a cell displays.
  IntervalSet samples(int axis, int cell, int reach) const;

 private:
  ParameterSpace space_;
  std::array<int, kMaxAxes> cells_{}, displayed_{};
  std::array<double, kMaxAxes> speed_{};
};

}  // namespace vitrine
