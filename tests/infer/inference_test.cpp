// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/inference.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <cmath>

#include "tests/infer/test_scene.h"

namespace vitrine::testing {
namespace {

constexpr InferenceOptions kSmall{.width = 96, .height = 72};

Frame load(const Store& store, const StoreKey& key, const Scene& scene) { return store.load_frame(key, scene).value(); }

std::vector<std::vector<glm::vec3>> all_textures(const Store& store, const Inference& inference) {
  std::vector<std::vector<glm::vec3>> textures;
  for (const Field& field : inference.fields)
    for (int64_t s = 0; s < field.space.sample_count(); ++s) textures.push_back(load_field_texture(store, field, s).texels);
  return textures;
}

class InferenceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    gpu = make_gpu();
    ASSERT_NE(gpu, nullptr);
    scene = make_ball_on_board();
    frames = draw_frames(*scene, smooth_truth(), kSmall, *gpu, work.store());
  }
  Inference infer(const Store& store) { return infer_textures(*scene, frames, store, *gpu, kSmall, silent_progress()); }

  std::unique_ptr<hal::Gpu> gpu;
  std::unique_ptr<Scene> scene;
  ScratchStore work;
  std::vector<StoreKey> frames;
};

TEST_F(InferenceTest, DrawsTheFramesAgain) {
  const Inference inference = infer(work.store());
  ASSERT_EQ(inference.objects.size(), 2u);
  for (int64_t sample = 0; sample < 8; ++sample) {
    const auto drawn = draw_inferred(work.store(), *scene, inference, kSmall, *gpu, sample);
    EXPECT_GT(psnr(drawn, load(work.store(), frames[static_cast<size_t>(sample)], *scene).combined), 45) << "sample " << sample;
  }
}

TEST_F(InferenceTest, LayersDependOnTheAxesThatTheyMust) {
  const Inference inference = infer(work.store());
  ASSERT_EQ(inference.fields.size(), 3u);  // the board has no specular light
  EXPECT_EQ(inference.fields[0].layer, "diffuse");
  EXPECT_EQ(inference.fields[0].axes, 2u);
  EXPECT_EQ(inference.fields[0].textures.size(), 2u);
  EXPECT_EQ(inference.fields[1].layer, "specular");
  EXPECT_EQ(inference.fields[1].axes, 3u);
  EXPECT_EQ(inference.fields[1].textures.size(), 8u);
  EXPECT_EQ(inference.fields[2].layer, "diffuse");
  EXPECT_EQ(inference.fields[2].drawn_object, 1);
}

TEST_F(InferenceTest, TextureSizesFollowTheScreen) {
  const Inference inference = infer(work.store());
  for (const DrawnObject& object : inference.objects)
    for (const int size : {object.texture_width, object.texture_height}) {
      EXPECT_EQ(size % 8, 0);
      EXPECT_GE(size, 32);
      EXPECT_LE(size, 256);
    }
}

TEST_F(InferenceTest, HolesAreFilledSmoothly) {
  const Inference inference = infer(work.store());
  const Field& field = inference.fields[0];
  const LinearTexture texture = load_field_texture(work.store(), field, 0);
  glm::vec3 low(1e9f), high(-1e9f);
  for (size_t i = 0; i < texture.texels.size(); ++i) {
    if (field.importance[i] < 0.5f) continue;
    low = glm::min(low, texture.texels[i]);
    high = glm::max(high, texture.texels[i]);
  }
  for (size_t i = 0; i < texture.texels.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(texture.texels[i][k], low[k] - 0.1f) << "texel " << i;
      EXPECT_LE(texture.texels[i][k], high[k] + 0.1f) << "texel " << i;
    }
}

TEST_F(InferenceTest, ImportanceSumsToThePixelsOfTheObject) {
  const Inference inference = infer(work.store());
  double screen = 0, texels = 0;
  for (const StoreKey& key : frames)
    for (const float c : load(work.store(), key, *scene).objects[0].coverage) screen += static_cast<double>(c) / 8;
  for (const float i : inference.fields[0].importance) texels += static_cast<double>(i);
  EXPECT_NEAR(texels / screen, 1, 0.02);
}

TEST_F(InferenceTest, ASecondRunFindsEverythingInTheStore) {
  struct Count final : Progress {
    int64_t total = 0, found = 0;
    void begin(const char*, int64_t all, int64_t already, const char*) override { total = all, found = already; }
    void advance(int64_t) override {}
    void end() override {}
  } count;
  const Inference first = infer(work.store());
  const Inference second = infer_textures(*scene, frames, work.store(), *gpu, kSmall, count);
  EXPECT_EQ(count.total, 12);
  EXPECT_EQ(count.found, 12);
  for (size_t f = 0; f < first.fields.size(); ++f) EXPECT_EQ(first.fields[f].importance, second.fields[f].importance);
}

// Stops after a number of textures.
struct Impatient final : Progress {
  std::atomic<int64_t> left;
  explicit Impatient(int64_t steps) : left(steps) {}
  void begin(const char*, int64_t, int64_t, const char*) override {}
  void advance(int64_t steps) override {
    if ((left -= steps) < 0) throw Interrupted();
  }
  void end() override {}
};

TEST_F(InferenceTest, InterruptedAndResumedItGivesTheSameBytes) {
  const auto whole = all_textures(work.store(), infer(work.store()));
  for (const int64_t steps : {0, 3, 9}) {
    ScratchStore other;
    ASSERT_EQ(draw_frames(*scene, smooth_truth(), kSmall, *gpu, other.store()), frames);
    Impatient impatient(steps);
    EXPECT_THROW(infer_textures(*scene, frames, other.store(), *gpu, kSmall, impatient), Interrupted);
    EXPECT_EQ(all_textures(other.store(), infer(other.store())), whole) << steps;
  }
}

TEST_F(InferenceTest, OneThreadGivesTheSameBytesAsFour) {
  const auto run = [&](size_t threads) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    ScratchStore other;
    draw_frames(*scene, smooth_truth(), kSmall, *gpu, other.store());
    return all_textures(other.store(), infer(other.store()));
  };
  EXPECT_EQ(run(1), run(4));
}

TEST_F(InferenceTest, WithLittleMemoryItUsesFewerViewsAndSaysSo) {
  InferenceOptions options = kSmall;
  options.max_matrix_bytes = size_t{96} * 72 * 4 * 48 * 2;  // two of four views
  const Inference inference = infer_textures(*scene, frames, work.store(), *gpu, options, silent_progress());
  ASSERT_EQ(inference.warnings.size(), 1u);
  EXPECT_NE(inference.warnings[0].find("every 2. view"), std::string::npos) << inference.warnings[0];
  const auto drawn = draw_inferred(work.store(), *scene, inference, options, *gpu, 0);
  EXPECT_GT(psnr(drawn, load(work.store(), frames[0], *scene).combined), 40);
}

TEST_F(InferenceTest, AMissingFrameIsAnErrorThatNamesIt) {
  frames[5].low ^= 1;
  try {
    infer(work.store());
    FAIL() << "no error";
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find(frames[5].hex()), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace vitrine::testing
