// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/reach.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "target/field_state.h"

namespace vitrine {
namespace {

constexpr AxisShape kLine{AxisKind::kLinear, 16}, kRing{AxisKind::kPeriodic, 16}, kSwitch{AxisKind::kDiscrete, 4};

TEST(Reach, CountsFramesToTheBorderOfWhatIsShown) {
  EXPECT_EQ(frames_along(kLine, 0.5f, false, 3.0f, 2, 4), 0u);
  EXPECT_EQ(frames_along(kLine, 0.5f, false, 3.0f, 5, 6), 3u);   // shown from 4.5 on
  EXPECT_EQ(frames_along(kLine, 0.5f, true, 3.0f, 5, 6), 2u);    // blended from 4 on
  EXPECT_EQ(frames_along(kRing, 0.5f, false, 15.0f, 0, 1), 1u);  // across the seam
  EXPECT_EQ(frames_along(kLine, 0.0f, false, 3.0f, 5, 6), kNever);
  EXPECT_EQ(frames_along(kSwitch, 0.0f, true, 1.0f, 1, 1), 0u);
  EXPECT_EQ(frames_along(kSwitch, 0.0f, true, 1.0f, 2, 2), kNever);
  EXPECT_EQ(frames_along(kLine, 0.5f, false, 3.0f, 5, 4), kNever);  // a cell off the grid
}

FieldShape random_shape(std::mt19937& random) {
  FieldShape shape;
  shape.space.axis_count = 2;
  shape.pyramid.level_count = 3;
  for (size_t a = 0; a < 2; ++a) {
    shape.space.axes[a] = {random() % 2 ? AxisKind::kLinear : AxisKind::kPeriodic, static_cast<int>(1 + random() % 20)};
    shape.block_size[a] = 4;
    shape.stagger[a] = static_cast<uint8_t>(random() % 4);
    for (size_t l = 0; l < 3; ++l) shape.pyramid.cell[l][a] = static_cast<uint8_t>(4 >> l);
  }
  return shape;
}

std::array<float, kMaxAxes> moved(const FieldShape& shape, std::array<float, kMaxAxes> x, float step0, float step1) {
  const float steps[2] = {step0, step1};
  for (size_t a = 0; a < 2; ++a) {
    const auto n = static_cast<float>(shape.space.axes[a].samples);
    x[a] += steps[a];
    if (shape.space.axes[a].kind == AxisKind::kPeriodic)
      x[a] -= n * std::floor(x[a] / n);
    else
      x[a] = std::clamp(x[a], 0.0f, n - 1);
  }
  return x;
}

TEST(Reach, ADeadlineNeverMovesCloserAsTimeGoesBy) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int trial = 0; trial < 40; ++trial) {
    const FieldShape shape = random_shape(random);
    const Motion motion{{0.3f, 1.1f}, trial % 2 == 0, 8};
    std::array<float, kMaxAxes> x{};
    for (int step = 0; step < 60; ++step) {
      const auto y = moved(shape, x, 0.3f * unit(random), 1.1f * unit(random));
      for (int node = 0; node < shape.node_count(); ++node) {
        const uint32_t before = frames_until(shape, motion, x, node), after = frames_until(shape, motion, y, node);
        if (before == kNever) continue;
        ASSERT_GE(after + 1, before);
      }
      x = y;
    }
  }
}

TEST(Reach, WhatIsShownIsDueNow) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int trial = 0; trial < 2000; ++trial) {
    const FieldShape shape = random_shape(random);
    const Position position{unit(random), unit(random)};
    const auto x = coordinates_of(shape.space, position);
    const GridIndex nearest = shape.space.nearest_sample(position);
    std::array<Corner, kMaxCorners> corners;
    const int count = corners_around(shape.space, position, corners);
    for (int level = 0; level < 3; ++level) {
      ASSERT_EQ(frames_until(shape, {{0.2f, 0.2f}, false, 4}, x, shape.node_of(nearest, level)), 0u);
      for (int i = 0; i < count; ++i)
        ASSERT_EQ(frames_until(shape, {{0.2f, 0.2f}, true, 4}, x, shape.node_of(corners[static_cast<size_t>(i)].index, level)),
                  0u);
    }
  }
}

TEST(Reach, JumpsAreStepsBeyondMaxSpeedAlongSomeAxis) {
  ParameterSpace space;
  space.axis_count = 2;
  space.axes[0] = kLine;
  space.axes[1] = kRing;
  const Motion motion{{0.5f, 0.5f}, false, 4};
  EXPECT_FALSE(is_jump(space, motion, {3, 15.8f}, {3.5f, 0.2f}));
  EXPECT_TRUE(is_jump(space, motion, {3, 0}, {3.6f, 0}));
  EXPECT_TRUE(is_jump(space, motion, {3, 4}, {3, 5}));
}

}  // namespace
}  // namespace vitrine
