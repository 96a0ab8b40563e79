// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/block.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace vitrine {
namespace {

bool is_power_of_two(int n) { return n > 0 && std::has_single_bit(static_cast<unsigned>(n)); }

int cells_per_block(const FieldShape& shape, int level) {
  int count = 1;
  for (int a = 0; a < shape.space.axis_count; ++a) count *= shape.block_size[a] / shape.pyramid.cell[level][a];
  return count;
}

bool valid_axis(const FieldShape& shape, int axis) {
  const int samples = shape.space.axes[axis].samples;
  if (samples < 1 || samples > std::numeric_limits<int>::max() - kMaxBlockSize) return false;
  const int block = shape.block_size[axis];
  if (!is_power_of_two(block) || block > kMaxBlockSize || shape.stagger[axis] >= block) return false;
  int coarser = block;
  for (int level = 0; level < shape.pyramid.level_count; ++level) {
    const int cell = shape.pyramid.cell[level][axis];
    if (!is_power_of_two(cell) || cell > coarser) return false;
    if (shape.pyramid.has_differences(level) && cell < coarser) return false;
    coarser = shape.pyramid.resolved(level, axis);
  }
  return coarser == 1;
}

// The top has no differences, and what they halve can be halved.
bool valid_differences(const FieldShape& shape) {
  for (int level = 0; level < shape.pyramid.level_count; ++level) {
    if (!shape.pyramid.has_differences(level)) continue;
    const int axis = shape.pyramid.halved[level];
    if (level == 0 || axis < 0 || axis >= shape.space.axis_count || shape.pyramid.cell[level][axis] < 2) return false;
  }
  return true;
}

}  // namespace

int PyramidShape::resolved(int level, int axis) const {
  const auto l = static_cast<size_t>(level);
  const int width = cell[l][static_cast<size_t>(axis)];
  return halved[l] == axis ? width / 2 : width;
}

bool FieldShape::valid() const {
  if (space.axis_count < 0 || space.axis_count > kMaxAxes) return false;
  if (pyramid.level_count < 1 || pyramid.level_count > kMaxLevels) return false;
  if (!valid_differences(*this)) return false;
  for (int a = 0; a < space.axis_count; ++a)
    if (!valid_axis(*this, a)) return false;
  // All counts fit an int: at most 2^16 nodes a block (13 levels of 8^4 cells), so the product cannot overflow an int64
  // before it is refused.
  int64_t count = nodes_per_block();
  for (int a = 0; a < space.axis_count; ++a) {
    count *= (static_cast<int64_t>(space.axes[a].samples) + stagger[a] - 1) / block_size[a] + 1;
    if (count > std::numeric_limits<int>::max()) return false;
  }
  return true;
}

int FieldShape::blocks_along(int axis) const { return (space.axes[axis].samples + stagger[axis] - 1) / block_size[axis] + 1; }

int FieldShape::block_count() const {
  int count = 1;
  for (int a = 0; a < space.axis_count; ++a) count *= blocks_along(a);
  return count;
}

int FieldShape::block_of(const GridIndex& sample) const {
  int block = 0;
  for (int a = 0; a < space.axis_count; ++a) block = block * blocks_along(a) + (sample[a] + stagger[a]) / block_size[a];
  return block;
}

int FieldShape::nodes_per_block() const {
  int count = 0;
  for (int level = 0; level < pyramid.level_count; ++level) count += cells_per_block(*this, level);
  return count;
}

int FieldShape::node_of(const GridIndex& sample, int level) const {
  int cell = 0;
  for (int a = 0; a < space.axis_count; ++a) {
    const int size = block_size[a], width = pyramid.cell[level][a];
    cell = cell * (size / width) + (sample[a] + stagger[a]) % size / width;
  }
  int first = 0;
  for (int l = 0; l < level; ++l) first += cells_per_block(*this, l);
  return block_of(sample) * nodes_per_block() + first + cell;
}

int FieldShape::level_of(int node) const {
  int rest = node % nodes_per_block(), level = 0;
  while (rest >= cells_per_block(*this, level)) rest -= cells_per_block(*this, level++);
  return level;
}

bool FieldShape::subtracts(const GridIndex& sample, int level) const {
  if (!pyramid.has_differences(level)) return false;
  const int axis = pyramid.halved[level], width = pyramid.cell[level][axis];
  return (sample[axis] + stagger[axis]) % width >= width / 2;
}

FieldShape::Box FieldShape::samples_of(int node) const {
  const int level = level_of(node);
  int block = node / nodes_per_block(), cell = node % nodes_per_block();
  for (int l = 0; l < level; ++l) cell -= cells_per_block(*this, l);
  Box box;
  bool empty = false;
  for (int a = space.axis_count - 1; a >= 0; --a) {
    const int width = pyramid.cell[level][a], cells = block_size[a] / width, blocks = blocks_along(a);
    const int first = block % blocks * block_size[a] + cell % cells * width - stagger[a];
    box.first[a] = std::max(first, 0);
    box.last[a] = std::min(first + width, space.axes[a].samples) - 1;
    empty = empty || box.last[a] < box.first[a];
    block /= blocks;
    cell /= cells;
  }
  if (empty) box = Box{GridIndex{}, {-1, -1, -1, -1}};
  return box;
}

}  // namespace vitrine
