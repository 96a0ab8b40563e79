// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/plan/sustained.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace vitrine {
namespace {

uint64_t ceil_div(uint64_t a, uint64_t b) { return (a + b - 1) / b; }

// The window of frames whose units go furthest beyond U a frame (Kadane), as its sum and length.
struct Window {
  uint64_t units = 0, frames = 0;
};
Window heaviest_window(std::span<const uint64_t> entering, uint64_t u) {
  Window current, best;
  const auto excess = [u](const Window& w) { return static_cast<int64_t>(w.units) - static_cast<int64_t>(u * w.frames); };
  for (const uint64_t units : entering) {
    if (excess(current) <= 0) current = {};
    current = {current.units + units, current.frames + 1};
    if (excess(current) > excess(best)) best = current;
  }
  return best;
}

// Walks one straight path, writing what enters in each frame.
class StraightPath {
 public:
  StraightPath(const AnchorLattice& anchors, const Demand& demand, const AnchorStep& direction)
      : anchors_(anchors), demand_(demand), direction_(direction) {}

  bool all_periodic() const {
    for (int a = 0; a < anchors_.axis_count(); ++a)
      if (direction_[a] != 0 && !anchors_.wraps(a)) return false;
    return true;
  }

  // Frames in which every moving axis has gone once around (or from end to end).
  int64_t lap_frames() const {
    double frames = 0;
    for (int a = 0; a < anchors_.axis_count(); ++a)
      if (direction_[a] != 0) frames = std::max(frames, anchors_.cells(a) / anchors_.speed(a));
    return static_cast<int64_t>(std::ceil(frames));
  }

  bool may_begin_at(const GridIndex& cell) const {
    for (int a = 0; a < anchors_.axis_count(); ++a)
      if ((direction_[a] > 0 && cell[a] == 0) || (direction_[a] < 0 && cell[a] == anchors_.cells(a) - 1)) return true;
    return false;
  }

  void walk(GridIndex cell, std::vector<uint64_t>& entering) const {
    entering.clear();
    const int64_t frames = (all_periodic() ? 2 : 1) * lap_frames();
    for (int64_t t = 1; t <= frames; ++t) {
      uint64_t units = 0;
      const bool inside = walk_frame(t, cell, units);
      entering.push_back(units);
      if (!inside) return;
    }
  }

 private:
  // Cells that an axis has stepped in all after `t` frames, the first of them in frame 1.
  int64_t steps_after(int axis, int64_t t) const {
    return direction_[axis] == 0 ? 0 : static_cast<int64_t>(std::ceil(anchors_.speed(axis) * static_cast<double>(t) - 1e-6));
  }

  // An axis that is faster than a cell a frame steps several times. False once the path has left the space.
  bool walk_frame(int64_t t, GridIndex& cell, uint64_t& units) const {
    for (int64_t substep = 1;; ++substep) {
      AnchorStep step{};
      bool moves = false;
      for (int a = 0; a < anchors_.axis_count(); ++a)
        if (steps_after(a, t) - steps_after(a, t - 1) >= substep) {
          step[a] = direction_[a];
          moves = true;
        }
      if (!moves) return true;
      units += demand_.entering_units[flat_index(cell) * static_cast<size_t>(step_count(anchors_.axis_count())) +
                                      static_cast<size_t>(step_number(step, anchors_.axis_count()))];
      if (!advance(step, cell)) return false;
    }
  }

  bool advance(const AnchorStep& step, GridIndex& cell) const {
    for (int a = 0; a < anchors_.axis_count(); ++a) {
      const int n = anchors_.cells(a);
      cell[a] += step[a];
      if (anchors_.wraps(a)) cell[a] = (cell[a] + n) % n;
      if (cell[a] < 0 || cell[a] >= n) return false;
    }
    return true;
  }

  size_t flat_index(const GridIndex& cell) const {
    size_t flat = 0;
    for (int a = 0; a < anchors_.axis_count(); ++a)
      flat = flat * static_cast<size_t>(anchors_.cells(a)) + static_cast<size_t>(cell[a]);
    return flat;
  }

  const AnchorLattice& anchors_;
  const Demand& demand_;
  AnchorStep direction_;
};

bool legal_direction(const AnchorLattice& anchors, const AnchorStep& direction) {
  bool moves = false;
  for (int a = 0; a < anchors.axis_count(); ++a) {
    if (direction[a] != 0 && !anchors.moves(a)) return false;
    moves = moves || direction[a] != 0;
  }
  return moves;
}

GridIndex cell_from_flat(const AnchorLattice& anchors, int64_t flat) {
  GridIndex cell{};
  for (int a = anchors.axis_count() - 1; a >= 0; --a) {
    cell[a] = static_cast<int>(flat % anchors.cells(a));
    flat /= anchors.cells(a);
  }
  return cell;
}

}  // namespace

uint64_t least_sustained_units(std::span<const uint64_t> entering, int horizon, uint64_t at_least) {
  uint64_t u = at_least;
  for (;;) {  // each round serves the worst window of the one before, so u only grows, and ends at the least that serves all
    const Window worst = heaviest_window(entering, u);
    const uint64_t needed = worst.frames == 0 ? u : ceil_div(worst.units, worst.frames + static_cast<uint64_t>(horizon));
    if (needed <= u) return u;
    u = needed;
  }
}

uint64_t worst_sustained_units(const AnchorLattice& anchors, const Demand& demand, int horizon) {
  uint64_t worst = 0;
  std::vector<uint64_t> entering;
  for (int number = 0; number < step_count(anchors.axis_count()); ++number) {
    const AnchorStep direction = step_from_number(number, anchors.axis_count());
    if (!legal_direction(anchors, direction)) continue;
    const StraightPath path(anchors, demand, direction);
    for (int64_t flat = 0; flat < anchors.cell_count(); ++flat) {
      const GridIndex cell = cell_from_flat(anchors, flat);
      if (!path.may_begin_at(cell)) continue;
      path.walk(cell, entering);
      worst = least_sustained_units(entering, horizon, worst);
      if (!path.all_periodic()) continue;
      const size_t lap = entering.size() / 2;  // the second lap, when all that the first one pays once is paid
      worst =
          std::max(worst, ceil_div(std::accumulate(entering.begin() + static_cast<ptrdiff_t>(lap), entering.end(), uint64_t{0}),
                                   entering.size() - lap));
    }
  }
  return worst;
}

}  // namespace vitrine
