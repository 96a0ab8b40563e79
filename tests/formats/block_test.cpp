// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/block.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace vitrine {
namespace {

// Halves axes in turn, from where the levels so far resolve.
void append_differences(FieldShape& shape, std::mt19937& random) {
  PyramidShape& pyramid = shape.pyramid;
  while (pyramid.level_count < kMaxLevels && random() % 4 != 0) {
    const int last = pyramid.level_count - 1, axis = static_cast<int>(random() % static_cast<unsigned>(shape.space.axis_count));
    if (pyramid.resolved(last, axis) < 2) continue;
    AxisSizes& cell = pyramid.cell[static_cast<size_t>(pyramid.level_count)];
    for (int a = 0; a < shape.space.axis_count; ++a)
      cell[static_cast<size_t>(a)] = static_cast<uint8_t>(pyramid.resolved(last, a));
    pyramid.halved[static_cast<size_t>(pyramid.level_count++)] = static_cast<int8_t>(axis);
  }
}

// A few levels of differences below the top, then residuals down to cells of one.
FieldShape random_shape_with_differences(std::mt19937& random) {
  FieldShape shape;
  shape.space.axis_count = 1 + static_cast<int>(random() % 3);
  for (int a = 0; a < shape.space.axis_count; ++a) {
    shape.space.axes[a].samples = 1 + static_cast<int>(random() % 14);
    shape.block_size[a] = shape.pyramid.cell[0][a] = 8;
    shape.stagger[a] = static_cast<uint8_t>(random() % 8);
  }
  append_differences(shape, random);
  for (int a = 0; a < shape.space.axis_count; ++a) shape.pyramid.cell[static_cast<size_t>(shape.pyramid.level_count)][a] = 1;
  if (shape.pyramid.level_count < kMaxLevels) ++shape.pyramid.level_count;
  return shape;
}

FieldShape random_shape(std::mt19937& random) {
  FieldShape shape;
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  shape.space.axis_count = below(kMaxAxes + 1);
  shape.pyramid.level_count = 1 + below(5);
  for (int a = 0; a < shape.space.axis_count; ++a) {
    shape.space.axes[a].samples = 1 + below(a < 2 ? 20 : 5);
    shape.block_size[a] = static_cast<uint8_t>(1 << below(4));
    shape.stagger[a] = static_cast<uint8_t>(below(shape.block_size[a]));
    int cell = shape.block_size[a];
    for (int level = 0; level < shape.pyramid.level_count; ++level) {
      while (cell > 1 && below(3) == 0) cell /= 2;
      if (level == shape.pyramid.level_count - 1) cell = 1;
      shape.pyramid.cell[level][a] = static_cast<uint8_t>(cell);
    }
  }
  return shape;
}

bool contains(const FieldShape& shape, const FieldShape::Box& box, const GridIndex& sample) {
  for (int a = 0; a < shape.space.axis_count; ++a)
    if (sample[a] < box.first[a] || sample[a] > box.last[a]) return false;
  return true;
}

TEST(Block, EverySampleLiesInExactlyOneNodePerLevel) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 60; ++trial) {
    const FieldShape shape = random_shape(random);
    ASSERT_TRUE(shape.valid());
    std::vector<int64_t> samples_in_level(static_cast<size_t>(shape.pyramid.level_count), 0);
    for (int node = 0; node < shape.node_count(); ++node) {
      const FieldShape::Box box = shape.samples_of(node);
      int64_t volume = 1;
      for (int a = 0; a < shape.space.axis_count; ++a) volume *= std::max(0, box.last[a] - box.first[a] + 1);
      samples_in_level[static_cast<size_t>(shape.level_of(node))] += volume;
    }
    for (const int64_t count : samples_in_level) ASSERT_EQ(count, shape.space.sample_count());
    for (int64_t flat = 0; flat < shape.space.sample_count(); ++flat) {
      const GridIndex sample = shape.space.index_from_flat(flat);
      for (int level = 0; level < shape.pyramid.level_count; ++level) {
        const int node = shape.node_of(sample, level);
        ASSERT_GE(node, 0);
        ASSERT_LT(node, shape.node_count());
        ASSERT_EQ(shape.level_of(node), level);
        ASSERT_TRUE(contains(shape, shape.samples_of(node), sample));
        ASSERT_EQ(shape.block_of(sample), node / shape.nodes_per_block());
      }
    }
  }
}

TEST(Block, CellsAreNoLargerThanTheirLevelSays) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 60; ++trial) {
    const FieldShape shape = random_shape(random);
    for (int node = 0; node < shape.node_count(); ++node) {
      const FieldShape::Box box = shape.samples_of(node);
      for (int a = 0; a < shape.space.axis_count; ++a)
        ASSERT_LE(box.last[a] - box.first[a] + 1, shape.pyramid.cell[shape.level_of(node)][a]);
    }
  }
}

TEST(Block, DifferencesAreAddedToTheFirstHalfOfTheirCellAndSubtractedFromTheSecond) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 60; ++trial) {
    const FieldShape shape = random_shape_with_differences(random);
    ASSERT_TRUE(shape.valid());
    for (int level = 0; level < shape.pyramid.level_count; ++level)
      for (int64_t flat = 0; flat < shape.space.sample_count(); ++flat) {
        const GridIndex sample = shape.space.index_from_flat(flat);
        if (!shape.pyramid.has_differences(level)) {
          ASSERT_FALSE(shape.subtracts(sample, level));
          continue;
        }
        const int axis = shape.pyramid.halved[static_cast<size_t>(level)], width = shape.pyramid.cell[level][axis];
        GridIndex partner = sample;
        const bool second = (sample[axis] + shape.stagger[axis]) % width >= width / 2;
        partner[axis] += second ? -width / 2 : width / 2;
        EXPECT_EQ(shape.subtracts(sample, level), second);
        if (partner[axis] < 0 || partner[axis] >= shape.space.axes[axis].samples) continue;
        EXPECT_EQ(shape.node_of(sample, level), shape.node_of(partner, level));
        EXPECT_NE(shape.subtracts(sample, level), shape.subtracts(partner, level));
      }
  }
}

TEST(Block, PyramidsWhoseDifferencesFitNoCellAreRefused) {
  FieldShape shape;
  shape.space.axis_count = 2;
  shape.space.axes[0].samples = shape.space.axes[1].samples = 8;
  shape.block_size = {8, 8};
  shape.pyramid.level_count = 3;
  shape.pyramid.cell = {AxisSizes{8, 1}, AxisSizes{8, 1}, AxisSizes{1, 1}};
  shape.pyramid.halved = {PyramidShape::kResiduals, 0, PyramidShape::kResiduals};
  ASSERT_TRUE(shape.valid());
  FieldShape broken = shape;
  broken.pyramid.halved[0] = 0;  // the top
  EXPECT_FALSE(broken.valid());
  broken = shape;
  broken.pyramid.halved[1] = 2;  // no such axis
  EXPECT_FALSE(broken.valid());
  broken.pyramid.halved[1] = -2;
  EXPECT_FALSE(broken.valid());
  broken = shape;
  broken.pyramid.halved[1] = 1;  // cells of one sample
  EXPECT_FALSE(broken.valid());
  broken = shape;
  broken.pyramid.cell[1] = {4, 1};  // not what the top resolves
  EXPECT_FALSE(broken.valid());
  broken = shape;
  broken.pyramid.cell[2] = {8, 1};  // larger than what is resolved
  EXPECT_FALSE(broken.valid());
  broken = shape;
  broken.pyramid.halved[2] = 0;
  broken.pyramid.cell[2] = {4, 1};  // ends with cells of two
  EXPECT_FALSE(broken.valid());
}

TEST(Block, TheStaggerShortensTheFirstBlock) {
  FieldShape shape;
  shape.space.axis_count = 1;
  shape.space.axes[0].samples = 20;
  shape.block_size[0] = 8;
  shape.stagger[0] = 3;
  shape.pyramid.level_count = 2;
  shape.pyramid.cell[0][0] = 8;
  shape.pyramid.cell[1][0] = 1;
  ASSERT_TRUE(shape.valid());
  EXPECT_EQ(shape.block_count(), 3);
  EXPECT_EQ(shape.nodes_per_block(), 9);
  EXPECT_EQ(shape.samples_of(0).last[0], 4);   // samples 0..4
  EXPECT_EQ(shape.samples_of(9).first[0], 5);  // 5..12
  EXPECT_EQ(shape.samples_of(18).last[0], 19);
  EXPECT_LT(shape.samples_of(1).last[0], shape.samples_of(1).first[0]);  // before the grid
  EXPECT_EQ(shape.block_of({4}), 0);
  EXPECT_EQ(shape.block_of({5}), 1);
  EXPECT_EQ(shape.block_of({19}), 2);
  EXPECT_EQ(shape.node_of({4}, 0), 0);
  EXPECT_EQ(shape.node_of({5}, 0), 9);
  EXPECT_EQ(shape.node_of({5}, 1), 10);
}

// Row-major, the last axis fastest: the numbering that files rely on.
TEST(Block, NodesAreNumberedBlockThenLevelThenCell) {
  FieldShape shape;
  shape.space.axis_count = 2;
  shape.space.axes[0].samples = 4;
  shape.space.axes[1].samples = 8;
  shape.block_size = {2, 4};
  shape.pyramid.level_count = 2;
  shape.pyramid.cell[0] = {2, 2};
  shape.pyramid.cell[1] = {1, 1};
  ASSERT_TRUE(shape.valid());
  EXPECT_EQ(shape.nodes_per_block(), 2 + 8);
  EXPECT_EQ(shape.node_of({0, 2}, 0), 1);
  EXPECT_EQ(shape.node_of({0, 4}, 0), 10);
  EXPECT_EQ(shape.node_of({2, 0}, 0), 20);
  EXPECT_EQ(shape.node_of({1, 0}, 1), 2 + 4);
  EXPECT_EQ(shape.node_of({3, 7}, 1), 30 + 2 + 7);
  EXPECT_EQ(shape.block_of({1, 3}), 0);
  EXPECT_EQ(shape.block_of({1, 4}), 1);
  EXPECT_EQ(shape.block_of({2, 3}), 2);
}

TEST(Block, AShapeThatCountsBeyondAnIntIsNotValid) {
  FieldShape shape;
  shape.space.axis_count = 4;
  for (int a = 0; a < 4; ++a) {
    shape.space.axes[a].samples = 4096;
    shape.block_size[a] = 1;
    shape.pyramid.cell[0][a] = 1;
  }
  EXPECT_FALSE(shape.valid());
  shape.space.axis_count = 1;
  EXPECT_TRUE(shape.valid());
  shape.space.axes[0].samples = std::numeric_limits<int>::max();
  EXPECT_FALSE(shape.valid());
  shape.space.axes[0].samples = 0;
  EXPECT_FALSE(shape.valid());
}

}  // namespace
}  // namespace vitrine
