// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/block.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace vitrine {
namespace {

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
