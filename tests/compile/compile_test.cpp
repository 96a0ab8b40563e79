// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/compile/compile.h"

#include <gtest/gtest.h>

#include "host/scene/scene.h"

namespace vitrine::test {
namespace {

TEST(TraceOptions, AnAxisThatGrowsALittleLeavesTheFramesThatThereAre) {
  const auto scene = load_scene(VITRINE_SOURCE_DIR "/tests/scenes/table");
  const auto counted = [&](int views, int lamps) {
    for (Axis& axis : scene->axes) axis.shape.samples = axis.name == "view" ? views : lamps;
    return trace_options(*scene).views;
  };
  const std::pair<int, int> expected[] = {{1, 1},   {2, 2},   {3, 2},   {5, 4},   {6, 5},   {8, 8},
                                          {12, 11}, {32, 32}, {40, 32}, {60, 45}, {64, 64}, {1000, 64}};
  for (const auto& [views, count] : expected) {
    EXPECT_EQ(counted(views, 1), count) << views << " views";
    EXPECT_EQ(counted(views, 8), count) << views << " views, each with eight positions of the lamp";
  }
}

TEST(InferenceOptions, TexturesAreInferredForTheDrawingThatWillPlayThem) {
  const auto scene = load_scene(VITRINE_SOURCE_DIR "/tests/scenes/table");
  const InferenceOptions options = inference_options(*scene, 3, SurfaceFilter::kAnisotropic4);
  EXPECT_EQ(options.width, scene->settings.width);
  EXPECT_EQ(options.height, scene->settings.height);
  EXPECT_EQ(options.supersampling, 3);
  EXPECT_EQ(options.filter, SurfaceFilter::kAnisotropic4);
}

// An image names the frames of the grid; whether others were traced beside them changes none of them.
TEST(FrameKeys, AreThoseOfTheGridWhateverIsTracedBetween) {
  const auto scene = load_scene(VITRINE_SOURCE_DIR "/tests/scenes/table");
  const auto keys = frame_keys(*scene);
  EXPECT_EQ(static_cast<int64_t>(keys.size()), scene->space().sample_count());
  scene->settings.between = true;
  EXPECT_EQ(frame_keys(*scene), keys);
}

}  // namespace
}  // namespace vitrine::test
