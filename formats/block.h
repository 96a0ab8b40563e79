// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Blocks and their pyramids: how a field's grid is cut into blocks with a staggered origin, which nodes a block has, and
// which of them make one leaf, and how (Hakura 2001, sections 4.1, 4.3, 4.7).
//
// A field depends on some axes of the space; its own grid is the space restricted to them. It is cut into blocks of
// `block_size` samples along each axis; the first block of an axis is short by `stagger`. A block is a pyramid: level l has
// one node per cell of `cell[l]` samples; the leaf of a sample is the signed sum of the nodes, one a level, whose cells hold
// that sample. Level 0 is the top (usually one cell: the whole block). There are two kinds of levels:
//
// - Residuals, with cells of any size that divides what the levels before tell apart: each node is added to all samples of
//   its cell. A pyramid of residuals only is the adaptive Laplacian pyramid.
// - Differences along one axis, with the cells that the levels before tell apart: each node is added to the samples in the
//   first half of its cell along that axis and subtracted from those in the second. Such levels make a Haar wavelet over the
//   parameter axes: half as many nodes as the same residuals would need, and every node serves both halves.
#pragma once

#include <array>
#include <cstdint>

#include "formats/parameter_space.h"

namespace vitrine {

inline constexpr int kMaxBlockSize = 8;  // samples along an axis
inline constexpr int kMaxLevels = 13;    // a top, and differences that halve four axes of eight samples

using AxisSizes = std::array<uint8_t, kMaxAxes>;

struct PyramidShape {
  static constexpr int8_t kResiduals = -1;

  int level_count = 1;                                // 1..kMaxLevels
  std::array<AxisSizes, kMaxLevels> cell{};           // power of two per axis
  std::array<int8_t, kMaxLevels> halved = no_axes();  // the axis of a level of differences; kResiduals

  bool has_differences(int level) const { return halved[static_cast<size_t>(level)] != kResiduals; }
  // The cells that the levels up to this one tell apart: samples along an axis.
  int resolved(int level, int axis) const;
  bool operator==(const PyramidShape&) const = default;

 private:
  static constexpr std::array<int8_t, kMaxLevels> no_axes() {
    std::array<int8_t, kMaxLevels> axes{};
    axes.fill(kResiduals);
    return axes;
  }
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
  // Whether that node is subtracted from the sample's leaf.
  bool subtracts(const GridIndex& sample, int level) const;
  // The samples in a node's cell, clipped to the grid: [first, last] per axis. Empty (last < first) for cells off the grid.
  struct Box {
    GridIndex first{}, last{};
  };
  Box samples_of(int node) const;
};

}  // namespace vitrine
