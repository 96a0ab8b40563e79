// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/plan/level_costs.h"

#include <algorithm>

namespace vitrine {

LevelCosts::LevelCosts(const EncodedField& field, int level) : axis_count_(field.shape.space.axis_count) {
  size_t size = 1;
  for (int a = axis_count_ - 1; a >= 0; --a) {
    stagger_[a] = field.shape.stagger[a];
    cell_[a] = field.shape.pyramid.cell[level][a];
    first_row_[a] = stagger_[a] / cell_[a];
    rows_[a] = (field.shape.space.axes[a].samples - 1 + stagger_[a]) / cell_[a] - first_row_[a] + 1;
    stride_[a] = size;
    size *= static_cast<size_t>(rows_[a]) + 1;
  }
  prefix_.resize(size);
  fill_prefix(field, level);
}

void LevelCosts::fill_prefix(const EncodedField& field, int level) {
  const auto row_of = [&](size_t i, int a) { return static_cast<int>(i / stride_[a] % (static_cast<size_t>(rows_[a]) + 1)) - 1; };
  for (size_t i = 0; i < prefix_.size(); ++i) {
    GridIndex sample{};
    bool border = false;  // entry 0 of an axis sums nothing
    for (int a = 0; a < axis_count_; ++a) {
      border = border || row_of(i, a) < 0;
      sample[a] = std::max(0, (row_of(i, a) + first_row_[a]) * cell_[a] - stagger_[a]);
    }
    const size_t node = border ? 0 : static_cast<size_t>(field.shape.node_of(sample, level));
    if (!border && field.node_bytes[node] > 0) prefix_[i] = {field.node_units[node], 1};
  }
  for (int a = 0; a < axis_count_; ++a)
    for (size_t i = 0; i < prefix_.size(); ++i)
      if (row_of(i, a) >= 0) {
        prefix_[i].units += prefix_[i - stride_[a]].units;
        prefix_[i].coded += prefix_[i - stride_[a]].coded;
      }
}

IntervalSet LevelCosts::rows_of(int axis, const IntervalSet& samples) const {
  const auto row = [&](int sample) { return (sample + stagger_[axis]) / cell_[axis] - first_row_[axis]; };
  IntervalSet rows;
  for (int i = 0; i < samples.count; ++i) rows.add(row(samples.parts[i].first), row(samples.parts[i].last));
  return rows;
}

NodeSum LevelCosts::prefix_sum(const NodeRows& rows, int axis, size_t index) const {
  if (axis == axis_count_) return prefix_[index];
  NodeSum sum;  // differences wrap around and come back
  for (int i = 0; i < rows[axis].count; ++i) {
    const Interval& part = rows[axis].parts[i];
    const NodeSum high = prefix_sum(rows, axis + 1, index + stride_[axis] * static_cast<size_t>(part.last + 1));
    const NodeSum low = prefix_sum(rows, axis + 1, index + stride_[axis] * static_cast<size_t>(part.first));
    sum.units += high.units - low.units;
    sum.coded += high.coded - low.coded;
  }
  return sum;
}

NodeSum LevelCosts::sum(const NodeRows& rows) const { return prefix_sum(rows, 0, 0); }

}  // namespace vitrine
