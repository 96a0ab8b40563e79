// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/sample_paths.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

namespace vitrine::test {
namespace {

ParameterSpace grid(int first, int second) {
  ParameterSpace space;
  space.axis_count = 2;
  space.axes[0].samples = first;
  space.axes[1].samples = second;
  return space;
}

FieldShape::Box box(int from0, int to0, int from1, int to1) { return {{from0, from1}, {to0, to1}}; }

int distance(const ParameterSpace& space, int64_t a, int64_t b) {
  const GridIndex p = space.index_from_flat(a), q = space.index_from_flat(b);
  return std::abs(p[0] - q[0]) + std::abs(p[1] - q[1]);
}

TEST(SamplePaths, a_video_shows_every_sample_of_the_block_once_and_never_jumps) {
  const ParameterSpace space = grid(10, 7);
  for (const int fastest : {0, 1}) {
    const auto path = zig_zag(space, box(2, 9, 1, 5), fastest);
    EXPECT_EQ(std::set<int64_t>(path.begin(), path.end()).size(), 40u);
    ASSERT_EQ(path.size(), 40u);
    for (size_t i = 1; i < path.size(); ++i)
      EXPECT_EQ(distance(space, path[i - 1], path[i]), 1) << "axis " << fastest << ", step " << i;
  }
}

TEST(SamplePaths, the_axis_that_is_to_vary_fastest_does) {
  const ParameterSpace space = grid(3, 3);
  EXPECT_EQ(zig_zag(space, box(0, 2, 0, 2), 0), (std::vector<int64_t>{0, 3, 6, 7, 4, 1, 2, 5, 8}));
  EXPECT_EQ(zig_zag(space, box(0, 2, 0, 2), 1), (std::vector<int64_t>{0, 1, 2, 5, 4, 3, 6, 7, 8}));
}

TEST(SamplePaths, a_field_that_does_not_depend_on_an_axis_has_no_path_along_it) {
  EXPECT_EQ(path_axes(grid(1, 7), box(0, 0, 1, 5)), (std::vector<int>{1}));
  EXPECT_EQ(path_axes(grid(1, 1), box(0, 0, 0, 0)), (std::vector<int>{0}));
  EXPECT_EQ(path_axes(grid(8, 8), box(0, 7, 0, 7)), (std::vector<int>{0, 1}));
}

TEST(SamplePaths, a_space_without_axes_is_one_picture) { EXPECT_EQ(zig_zag({}, {}, 0), (std::vector<int64_t>{0})); }

}  // namespace
}  // namespace vitrine::test
