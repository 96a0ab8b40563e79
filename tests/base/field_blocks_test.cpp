// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/base/field_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace vitrine {
namespace {

TEST(BlockSize, HoldsAllSamplesUpToEight) {
  ParameterSpace space;
  space.axis_count = 4;
  for (size_t a = 0; a < 4; ++a) space.axes[a].samples = std::array{1, 3, 8, 64}[a];
  EXPECT_EQ(block_size_of(space), (AxisSizes{1, 4, 8, 8}));
}

TEST(BlockSize, IsOneSampleAlongSwitches) {
  ParameterSpace space;
  space.axis_count = 2;
  space.axes[0] = {AxisKind::kDiscrete, 6};
  space.axes[1] = {AxisKind::kPeriodic, 6};
  EXPECT_EQ(block_size_of(space), (AxisSizes{1, 8}));
}

TEST(Stagger, IsWithinTheBlockAndSpreadEvenly) {
  ParameterSpace space;
  space.axis_count = 3;
  space.axes = {{{AxisKind::kLinear, 64}, {AxisKind::kPeriodic, 32}, {AxisKind::kLinear, 5}}};
  const AxisSizes block{8, 4, 8};
  for (const int count : {1, 2, 5, 8, 16, 23}) {
    std::array<std::array<int, 8>, 3> used{};
    for (int f = 0; f < count; ++f) {
      const AxisSizes stagger = stagger_of(f, count, space, block);
      for (int a = 0; a < 3; ++a) {
        ASSERT_LT(stagger[a], block[a]);
        ++used[static_cast<size_t>(a)][stagger[a]];
      }
      EXPECT_EQ(stagger[2], 0);  // one block holds the whole axis
    }
    for (int a = 0; a < 2; ++a)
      for (int s = 0; s < block[a]; ++s) {
        EXPECT_LE(used[static_cast<size_t>(a)][static_cast<size_t>(s)], (count + block[a] - 1) / block[a])
            << count << " axis " << a;
      }
  }
}

}  // namespace
}  // namespace vitrine
