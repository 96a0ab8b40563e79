// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/frozen_scene.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace vitrine::test {
namespace {

double difference(const glm::mat4& a, const glm::mat4& b) {
  double most = 0;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) most = std::max(most, std::abs(static_cast<double>(a[c][r]) - static_cast<double>(b[c][r])));
  return most;
}

// Everything stands at sample `index` of the part where it does at `index + first` of the whole.
void expect_same_poses(const Scene& whole, const Scene& part, const GridIndex& first) {
  const ParameterSpace space = part.space();
  for (int64_t i = 0; i < space.sample_count(); ++i) {
    const GridIndex index = space.index_from_flat(i);
    GridIndex original = index;
    for (size_t a = 0; a < original.size(); ++a) original[a] += first[a];
    const Pose expected = pose_scene(whole, whole.space().position_of(original)),
               pose = pose_scene(part, space.position_of(index));
    for (size_t n = 0; n < pose.world_from_node.size(); ++n)
      ASSERT_LT(difference(pose.world_from_node[n], expected.world_from_node[n]), 1e-6) << "sample " << i << ", node " << n;
  }
}

TEST(MiddlePart, a_block_of_the_table_shows_what_the_whole_grid_shows_there) {
  const auto scene = load_scene(VITRINE_SOURCE_DIR "/tests/scenes/table");
  const Scene part = middle_part(*scene, std::array{8, 4});
  ASSERT_EQ(part.space().sample_count(), 32);
  expect_same_poses(*scene, part, {28, 2});
  for (const RigTrack& track : part.tracks)
    for (const float position : track.positions) EXPECT_TRUE(position >= 0 && position <= 1) << "no image could hold it";
}

TEST(MiddlePart, a_part_of_a_turn_is_no_turn) {
  const auto scene = load_scene(VITRINE_SOURCE_DIR "/tests/scenes/ring");
  const Scene part = middle_part(*scene, std::array{8, 8});
  EXPECT_EQ(part.axes[1].shape.kind, AxisKind::kLinear);
  expect_same_poses(*scene, part, {8, 20});
}

TEST(MiddlePart, an_axis_of_fewer_samples_is_kept_whole) {
  const auto scene = load_scene(VITRINE_SOURCE_DIR "/tests/scenes/ring");
  const Scene part = middle_part(*scene, std::array{1, 1000});
  EXPECT_EQ(part.axes[0].shape.samples, 1);
  EXPECT_EQ(part.axes[1].shape.samples, 48);
  EXPECT_EQ(part.axes[1].shape.kind, AxisKind::kPeriodic);
  expect_same_poses(*scene, part, {11, 0});
}

}  // namespace
}  // namespace vitrine::test
