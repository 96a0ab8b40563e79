// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What a block's nodes have to do with its leaves: which leaves a node makes, and how much of each it should hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/block.h"

namespace vitrine {

inline constexpr int kShareLog2 = 16;  // fraction bits of a leaf's share

// A node and the samples of its cell. The leaves of a block are listed row-major in the part of the grid that it covers.
struct BlockCell {
  int node;                      // within the block
  std::vector<size_t> leaves;    // places in the block's list of leaves
  std::vector<bool> subtracted;  // per leaf: FieldShape::subtracts
  // Per leaf: the node holds the sum of shares * leaves / 2^kShareLog2. Of residuals that is a mean; of differences half of
  // what the means of the two halves differ by. Where later levels halve a cell, its mean is that of its halves' means, so
  // that their differences complete it even where one of them lies partly off the grid.
  std::vector<int32_t> shares;
};

// The cells of a level that hold samples; of differences: those with samples in both halves.
std::vector<BlockCell> cells_of_level(const FieldShape& shape, int block, int level);

// The grid sample of each of the block's leaves.
std::vector<GridIndex> samples_of_block(const FieldShape& shape, int block);

}  // namespace vitrine
