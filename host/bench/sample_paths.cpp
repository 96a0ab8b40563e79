// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/sample_paths.h"

namespace vitrine {
namespace {

// Axes of the space, `fastest` first.
std::vector<size_t> axis_order(const ParameterSpace& space, int fastest) {
  std::vector<size_t> order{static_cast<size_t>(fastest)};
  for (int axis = space.axis_count - 1; axis >= 0; --axis)
    if (axis != fastest) order.push_back(static_cast<size_t>(axis));
  return order;
}

}  // namespace

std::vector<int64_t> zig_zag(const ParameterSpace& space, const FieldShape::Box& box, int fastest) {
  if (space.axis_count == 0) return {0};
  const std::vector<size_t> order = axis_order(space, fastest);
  GridIndex index = box.first;
  std::array<int, kMaxAxes> direction;
  direction.fill(1);
  std::vector<int64_t> samples;
  for (;;) {
    samples.push_back(space.flat_from_index(index));
    size_t i = 0;
    for (; i < order.size(); ++i) {
      const size_t axis = order[i];
      const int next = index[axis] + direction[axis];
      if (next >= box.first[axis] && next <= box.last[axis]) {
        index[axis] = next;
        break;
      }
      direction[axis] = -direction[axis];  // this one turns round, the next takes a step
    }
    if (i == order.size()) return samples;
  }
}

std::vector<int> path_axes(const ParameterSpace& space, const FieldShape::Box& box) {
  std::vector<int> axes;
  for (int axis = 0; axis < space.axis_count; ++axis)
    if (box.last[static_cast<size_t>(axis)] > box.first[static_cast<size_t>(axis)]) axes.push_back(axis);
  if (axes.empty()) axes.push_back(0);
  return axes;
}

}  // namespace vitrine
