// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/compile/compile.h"

#include <gtest/gtest.h>

#include "host/scene/scene.h"

namespace vitrine::test {
namespace {

TEST(TraceOptions, FewerViewsAreCountedOnThanThereAreAndNearlyAsManyCountTheSame) {
  const auto scene = load_scene(VITRINE_SOURCE_DIR "/tests/scenes/table");
  const auto counted = [&](int views, int lamps) {
    for (Axis& axis : scene->axes) axis.shape.samples = axis.name == "view" ? views : lamps;
    return trace_options(*scene).views;
  };
  const std::pair<int, int> expected[] = {{1, 1},  {2, 1},   {5, 1},   {6, 2},   {8, 2},   {12, 4},   {16, 5},
                                          {24, 8}, {32, 11}, {48, 16}, {60, 16}, {64, 22}, {100, 32}, {1000, 32}};
  for (const auto& [views, count] : expected) {
    EXPECT_EQ(counted(views, 1), count) << views << " views";
    EXPECT_EQ(counted(views, 8), count) << views << " views, each with eight positions of the lamp";
  }
}

}  // namespace
}  // namespace vitrine::test
