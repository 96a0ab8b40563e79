// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Blocks and their pyramids: how a field's grid is cut into blocks with a staggered origin, which nodes a block has, and
// which of them make one leaf (Hakura 2001, sections 4.1, 4.3, 4.7).
//
// A field depends on some axes of the space; its own grid is the space restricted to them. It is cut into blocks of
// `block_size` samples along each axis; the first block of an axis is short by `stagger`. A block is an adaptive Laplacian
// pyramid: level l has one node per cell of `cell[l]` samples; the leaf of a sample is the sum of the nodes, one a level,
// whose cells hold that sample. Level 0 is the top (usually one cell: the whole block); the last level has cells of one.
#pragma once

#include <array>
#include <cstdint>

#include "formats/parameter_space.h"

namespace vitrine {

inline constexpr int kMaxBlockSize = 8;  // samples along an axis
inline constexpr int kMaxLevels = 8;

using AxisSizes = std::array<uint8_t, kMaxAxes>;

struct PyramidShape {
  int level_count = 1;                       // 1..kMaxLevels
  std::array<AxisSizes, kMaxLevels> cell{};  // power of two per axis, never grows from one level to the next
};

struct FieldShape {
  ParameterSpace space;    // already restricted to the field's axes
  AxisSizes block_size{};  // 1..kMaxBlockSize per axis, a power of two
  AxisSizes stagger{};     // 0..block_size-1 per axis
  PyramidShape pyramid;    // one shape for all blocks of the field

  // Ok, or what contradicts itself. Everything below may be called only on a shape that passed.
  bool valid() const;
  // How many blocks lie along an axis, and in all.
  int blocks_along(int axis) const;
  int block_count() const;
  // The block that holds the sample, row-major, last axis fastest.
  int block_of(const GridIndex& sample) const;
  // Nodes of one block (edge blocks number theirs like a full one; cells without samples have no bytes), and in all.
  int nodes_per_block() const;
  int node_count() const { return block_count() * nodes_per_block(); }
  // The node of `level` whose cell holds the sample: block-major, then level, then cell (row-major, last axis fastest).
  int node_of(const GridIndex& sample, int level) const;
  int level_of(int node) const;
  // The samples in a node's cell, clipped to the grid: [first, last] per axis. Empty (last < first) for cells off the grid.
  struct Box {
    GridIndex first{}, last{};
  };
  Box samples_of(int node) const;
};

}  // namespace vitrine
