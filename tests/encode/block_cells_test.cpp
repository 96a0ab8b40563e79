// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/block_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace vitrine {
namespace {

// Differences along the first axis, then the second, as deep as they go; or residuals in between.
FieldShape halving_shape(const std::vector<int>& samples, const AxisSizes& stagger, bool residuals_between) {
  FieldShape shape;
  shape.space.axis_count = static_cast<int>(samples.size());
  shape.stagger = stagger;
  PyramidShape& pyramid = shape.pyramid;
  for (size_t a = 0; a < samples.size(); ++a) {
    shape.space.axes[a].samples = samples[a];
    shape.block_size[a] = pyramid.cell[0][a] = 8;
  }
  for (size_t a = 0; a < samples.size(); ++a)
    for (int width = 8; width > 1; width /= 2) {
      const auto level = static_cast<size_t>(pyramid.level_count++);
      for (size_t b = 0; b < samples.size(); ++b)
        pyramid.cell[level][b] = static_cast<uint8_t>(pyramid.resolved(static_cast<int>(level) - 1, static_cast<int>(b)));
      if (residuals_between && width == 4)
        pyramid.cell[level][a] = 2;
      else
        pyramid.halved[level] = static_cast<int8_t>(a);
    }
  return shape;
}

// Codes a block without loss, level by level, and returns the largest part of a leaf that is left.
double rest_of_block(const FieldShape& shape, int block, std::vector<double> leaves) {
  for (int level = 0; level < shape.pyramid.level_count; ++level)
    for (const BlockCell& cell : cells_of_level(shape, block, level)) {
      double node = 0;
      for (size_t l = 0; l < cell.leaves.size(); ++l) node += std::ldexp(cell.shares[l], -kShareLog2) * leaves[cell.leaves[l]];
      for (size_t l = 0; l < cell.leaves.size(); ++l) leaves[cell.leaves[l]] -= cell.subtracted[l] ? -node : node;
    }
  double most = 0;
  for (const double leaf : leaves) most = std::max(most, std::fabs(leaf));
  return most;
}

TEST(BlockCells, LosslessNodesLeaveNothingOfAnyBlockWhereverItIsCutOff) {
  std::mt19937 random(1);
  for (const bool residuals_between : {false, true})
    for (int trial = 0; trial < 40; ++trial) {
      const std::vector<int> samples = {1 + static_cast<int>(random() % 20), 1 + static_cast<int>(random() % 11)};
      const FieldShape shape =
          halving_shape(samples, {static_cast<uint8_t>(random() % 8), static_cast<uint8_t>(random() % 8)}, residuals_between);
      ASSERT_TRUE(shape.valid());
      for (int block = 0; block < shape.block_count(); ++block) {
        std::vector<double> leaves;
        for (size_t i = 0; i < samples_of_block(shape, block).size(); ++i) leaves.push_back(static_cast<double>(random() % 4096));
        EXPECT_LT(rest_of_block(shape, block, leaves), 4096 * 64 * std::ldexp(1.0, -kShareLog2)) << "block " << block;
      }
    }
}

TEST(BlockCells, EveryLeafOfABlockLiesInOneCellOfEveryLevelOfResiduals) {
  const FieldShape shape = halving_shape({11, 8}, {3, 0}, true);
  for (int block = 0; block < shape.block_count(); ++block)
    for (int level = 0; level < shape.pyramid.level_count; ++level) {
      if (shape.pyramid.has_differences(level)) continue;
      std::vector<int> seen(samples_of_block(shape, block).size(), 0);
      for (const BlockCell& cell : cells_of_level(shape, block, level))
        for (const size_t leaf : cell.leaves) ++seen[leaf];
      for (const int count : seen) EXPECT_EQ(count, 1);
    }
}

TEST(BlockCells, HalvesOffTheGridHaveNoDifferences) {
  const FieldShape shape = halving_shape({3}, {5}, false);           // the first block has its last three places only
  const std::vector<BlockCell> cells = cells_of_level(shape, 0, 1);  // halves of eight
  EXPECT_TRUE(cells.empty());
}

}  // namespace
}  // namespace vitrine
