// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/parameter_space.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace vitrine {
namespace {

ParameterSpace random_space(std::mt19937& random) {
  ParameterSpace space;
  space.axis_count = static_cast<int>(random() % (kMaxAxes + 1));
  for (int a = 0; a < space.axis_count; ++a)
    space.axes[a] = {static_cast<AxisKind>(random() % 3), 1 + static_cast<int>(random() % 7)};
  return space;
}

Position random_position(std::mt19937& random) {
  Position position{};
  for (float& p : position) {
    p = static_cast<float>(random() % 4096) / 4095;
    if (random() % 8 == 0) p = std::round(p);
  }
  return position;
}

TEST(ParameterSpace, FlatNumbersAndIndexesAreOneToOne) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const ParameterSpace space = random_space(random);
    for (int64_t flat = 0; flat < space.sample_count(); ++flat)
      ASSERT_EQ(space.flat_from_index(space.index_from_flat(flat)), flat);
  }
}

TEST(ParameterSpace, ASampleIsNearestToItsOwnPositionAndItsOnlyCorner) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const ParameterSpace space = random_space(random);
    for (int64_t flat = 0; flat < space.sample_count(); ++flat) {
      const GridIndex index = space.index_from_flat(flat);
      const Position position = space.position_of(index);
      ASSERT_EQ(space.nearest_sample(position), index);
      std::array<Corner, kMaxCorners> corners;
      const int count = corners_around(space, position, corners);
      float weight = 0;
      for (int i = 0; i < count; ++i)
        if (corners[i].index == index) weight = corners[i].weight;
      ASSERT_NEAR(weight, 1, 1e-5);
    }
  }
}

TEST(ParameterSpace, CornerWeightsSumToOneAndAscendByFlatNumber) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 5000; ++trial) {
    const ParameterSpace space = random_space(random);
    std::array<Corner, kMaxCorners> corners;
    const int count = corners_around(space, random_position(random), corners);
    ASSERT_GE(count, 1);
    double sum = 0;
    for (int i = 0; i < count; ++i) {
      ASSERT_GT(corners[i].weight, 0);
      sum += corners[i].weight;
      ASSERT_LT(space.flat_from_index(corners[i].index), space.sample_count());
      if (i > 0) {
        ASSERT_LT(space.flat_from_index(corners[i - 1].index), space.flat_from_index(corners[i].index));
      }
    }
    ASSERT_NEAR(sum, 1, 1e-5);
  }
}

TEST(ParameterSpace, TheNearestSampleIsACornerOfTheGreatestWeight) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 5000; ++trial) {
    const ParameterSpace space = random_space(random);
    const Position position = random_position(random);
    std::array<Corner, kMaxCorners> corners;
    const int count = corners_around(space, position, corners);
    float greatest = 0, nearest = -1;
    for (int i = 0; i < count; ++i) {
      greatest = std::max(greatest, corners[i].weight);
      if (corners[i].index == space.nearest_sample(position)) nearest = corners[i].weight;
    }
    ASSERT_NEAR(nearest, greatest, 1e-5);
  }
}

// Multilinear weights reproduce every function that is linear between the samples.
TEST(ParameterSpace, LinearFunctionsArePreservedAlongLinearAxes) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 1000; ++trial) {
    ParameterSpace space = random_space(random);
    for (AxisShape& axis : space.axes) axis.kind = AxisKind::kLinear;
    const Position position = random_position(random);
    std::array<Corner, kMaxCorners> corners;
    const int count = corners_around(space, position, corners);
    for (int a = 0; a < space.axis_count; ++a) {
      double mean = 0;
      for (int i = 0; i < count; ++i) mean += corners[i].weight * corners[i].index[a];
      ASSERT_NEAR(mean, space.sample_coordinate(a, position[a]), 1e-4);
    }
  }
}

TEST(ParameterSpace, PeriodicAxesWrapAndOthersDoNot) {
  ParameterSpace space;
  space.axis_count = 1;
  space.axes[0] = {AxisKind::kPeriodic, 8};
  EXPECT_EQ(space.nearest_sample({1.0f})[0], 0);
  EXPECT_EQ(space.nearest_sample({0.99f})[0], 0);
  std::array<Corner, kMaxCorners> corners;
  ASSERT_EQ(corners_around(space, {15.0f / 16}, corners), 2);
  EXPECT_EQ(corners[0].index[0], 0);
  EXPECT_EQ(corners[1].index[0], 7);
  space.axes[0].kind = AxisKind::kLinear;
  EXPECT_EQ(space.nearest_sample({1.0f})[0], 7);
  ASSERT_EQ(corners_around(space, {1.0f}, corners), 1);
  space.axes[0].kind = AxisKind::kDiscrete;
  ASSERT_EQ(corners_around(space, {0.5f}, corners), 1);
}

TEST(ParameterSpace, PositionsThatAreNoneAreClamped) {
  ParameterSpace space;
  space.axis_count = 1;
  space.axes[0] = {AxisKind::kLinear, 5};
  EXPECT_EQ(space.nearest_sample({-3.0f})[0], 0);
  EXPECT_EQ(space.nearest_sample({7.0f})[0], 4);
  EXPECT_EQ(space.nearest_sample({std::numeric_limits<float>::quiet_NaN()})[0], 0);
  EXPECT_EQ(space.nearest_sample({std::numeric_limits<float>::infinity()})[0], 4);
}

}  // namespace
}  // namespace vitrine
