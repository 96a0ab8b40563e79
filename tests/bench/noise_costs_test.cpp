// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/noise_costs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "host/compile/compile.h"
#include "host/scene/scene.h"

namespace vitrine::test {
namespace {

constexpr double kLarge = 90;  // dB: no noise to speak of

// The table, small, evenly sampled, from some views around it.
std::unique_ptr<Scene> table_from(int views) {
  auto scene = load_scene(VITRINE_SOURCE_DIR "/tests/scenes/table");
  scene->settings.width = 80;
  scene->settings.height = 60;
  scene->settings.samples_per_pixel = 4;
  scene->settings.noise_db = 0;
  for (Axis& axis : scene->axes) axis.shape.samples = axis.name == "view" ? views : 1;
  return scene;
}

NoiseCost measure(int views, bool infer) {
  std::string folder = (std::filesystem::temp_directory_path() / "vitrine-bench-XXXXXX").string();
  EXPECT_NE(mkdtemp(folder.data()), nullptr);
  const auto scene = table_from(views);
  const NoiseCost cost = measure_noise(*scene, trace_options(*scene), infer, Store(folder), silent_progress());
  std::filesystem::remove_all(folder);
  return cost;
}

const LayerCost& layer_of(const NoiseCost& cost, const char* object, const char* layer) {
  return *std::find_if(cost.layers.begin(), cost.layers.end(),
                       [&](const LayerCost& l) { return l.object == object && l.layer == layer; });
}

TEST(NoiseCosts, LayersThatViewsShareAreMeasuredAfterTheAverageOverThem) {
  const NoiseCost one = measure(1, true), eight = measure(8, true);
  const auto gain = [&](const char* object, const char* layer) {
    return layer_of(eight, object, layer).inferred_db.value() - layer_of(one, object, layer).inferred_db.value();
  };
  EXPECT_GT(gain("floor", "diffuse"), 3);  // of the 9 dB that eight times the samples are worth where all views see it
  EXPECT_LT(gain("cup", "specular"), 3);   // every view has its own
  EXPECT_NEAR(layer_of(eight, "floor", "diffuse").frame_db, layer_of(one, "floor", "diffuse").frame_db, 2);
}

TEST(NoiseCosts, NoLayerIsNoisierInTexturesThanItsObjectIsAltogether) {
  const NoiseCost cost = measure(2, true);
  ASSERT_FALSE(cost.layers.empty());
  for (const LayerCost& layer : cost.layers) {
    ASSERT_TRUE(layer.inferred_db) << layer.object;
    EXPECT_LT(*layer.inferred_db, kLarge) << layer.object << ' ' << layer.layer;
    const auto drawn =
        std::find_if(cost.drawn.begin(), cost.drawn.end(), [&](const DrawnCost& d) { return d.object == layer.object; });
    ASSERT_NE(drawn, cost.drawn.end()) << layer.object;
    // A layer's noise is a part of the object's, unless by chance the layers' noises cancel.
    EXPECT_GT(*layer.inferred_db, drawn->db - 1) << layer.object << ' ' << layer.layer;
  }
}

TEST(NoiseCosts, FramesAloneSayNothingOfTextures) {
  const NoiseCost cost = measure(1, false);
  ASSERT_FALSE(cost.layers.empty());
  for (const LayerCost& layer : cost.layers) EXPECT_FALSE(layer.inferred_db) << layer.object;
  EXPECT_TRUE(cost.drawn.empty());
}

}  // namespace
}  // namespace vitrine::test
