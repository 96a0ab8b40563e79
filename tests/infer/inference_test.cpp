// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/inference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "host/infer/geometry_states.h"
#include "tests/infer/test_scene.h"

namespace vitrine::testing {
namespace {

constexpr float kHole = 0.01f;  // pixels that a texel feeds through coarse MIP levels at most
constexpr InferenceOptions kSmall{.width = 96, .height = 72};

Frame load(const Store& store, const StoreKey& key, const Scene& scene) { return store.load_frame(key, scene).value(); }

std::vector<std::vector<glm::vec3>> all_textures(const Store& store, const Inference& inference) {
  std::vector<std::vector<glm::vec3>> textures;
  for (const Field& field : inference.fields)
    for (int64_t s = 0; s < field.space.sample_count(); ++s) textures.push_back(load_field_texture(store, field, s).texels);
  return textures;
}

// Frames are drawn, and textures inferred, once for all tests that only look.
class InferenceTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    gpu = make_gpu();
    ASSERT_NE(gpu, nullptr);
    scene = make_ball_on_board();
    work = std::make_unique<ScratchStore>();
    frames = draw_frames(*scene, smooth_truth(), kSmall, *gpu, work->store());
    inference = infer(work->store());
  }
  static void TearDownTestSuite() {
    work.reset();
    scene.reset();
    gpu.reset();
  }
  static Inference infer(const Store& store) { return infer_textures(*scene, frames, store, *gpu, kSmall, silent_progress()); }
  // A store with the frames and nothing else.
  static std::unique_ptr<ScratchStore> fresh_store() {
    auto store = std::make_unique<ScratchStore>();
    for (const StoreKey& key : frames) store->store().save_frame(key, *scene, load(work->store(), key, *scene));
    return store;
  }

  static std::unique_ptr<hal::Gpu> gpu;
  static std::unique_ptr<Scene> scene;
  static std::unique_ptr<ScratchStore> work;
  static std::vector<StoreKey> frames;
  static Inference inference;
};
std::unique_ptr<hal::Gpu> InferenceTest::gpu;
std::unique_ptr<Scene> InferenceTest::scene;
std::unique_ptr<ScratchStore> InferenceTest::work;
std::vector<StoreKey> InferenceTest::frames;
Inference InferenceTest::inference;

TEST_F(InferenceTest, DrawsTheFramesAgain) {
  ASSERT_EQ(inference.objects.size(), 2u);
  for (int64_t sample = 0; sample < 8; ++sample) {
    const auto drawn = draw_inferred(work->store(), *scene, inference, kLayers, kSmall, *gpu, sample);
    EXPECT_GT(psnr(drawn, load(work->store(), frames[static_cast<size_t>(sample)], *scene).combined), 45) << "sample " << sample;
  }
}

// What one layer gives to a frame.
std::vector<glm::vec3> layer_of_frame(const Frame& frame, Layer layer) {
  std::vector<glm::vec3> picture(frame.combined.size(), glm::vec3(0));
  for (const ObjectFrame& o : frame.objects)
    for (int i = 0; i < o.width * o.height; ++i) {
      const auto k = static_cast<size_t>(i);
      const auto pixel = static_cast<size_t>((o.y + i / o.width) * frame.width + o.x + i % o.width);
      picture[pixel] += o.coverage[k] * (layer == Layer::kDiffuse ? o.diffuse[k] : o.specular[k]);
    }
  return picture;
}

TEST_F(InferenceTest, NoiseOfOneLayerIsSeenInPicturesOfThatLayerAlone) {
  for (const int64_t sample : {0, 5}) {
    const Frame frame = load(work->store(), frames[static_cast<size_t>(sample)], *scene);
    const auto all = draw_inferred(work->store(), *scene, inference, kLayers, kSmall, *gpu, sample);
    std::vector<glm::vec3> sum(all.size(), glm::vec3(0));
    for (const Layer layer : kLayers) {
      const auto alone = draw_inferred(work->store(), *scene, inference, {&layer, 1}, kSmall, *gpu, sample);
      EXPECT_GT(psnr(alone, layer_of_frame(frame, layer)), 45) << layer_name(layer) << ", sample " << sample;
      for (size_t i = 0; i < sum.size(); ++i) sum[i] += alone[i];
    }
    EXPECT_GT(psnr(sum, all), 120) << "sample " << sample;
  }
}

TEST_F(InferenceTest, LayersDependOnTheAxesThatTheyMust) {
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
  for (const Field& field : inference.fields)
    for (const int size : {field.texture_width, field.texture_height}) {
      EXPECT_EQ(size % 8, 0);
      EXPECT_GE(size, 32);
      EXPECT_LE(size, 256);
    }
}

TEST_F(InferenceTest, HolesAreFilledSmoothly) {
  const Field& field = inference.fields[0];
  const LinearTexture texture = load_field_texture(work->store(), field, 0);
  glm::vec3 low(1e9f), high(-1e9f);
  for (size_t i = 0; i < texture.texels.size(); ++i) {
    if (field.importance[0][i] < kHole) continue;
    low = glm::min(low, texture.texels[i]);
    high = glm::max(high, texture.texels[i]);
  }
  ASSERT_GT(std::count_if(field.importance[0].begin(), field.importance[0].end(), [](float i) { return i < kHole; }), 100);
  for (size_t i = 0; i < texture.texels.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(texture.texels[i][k], low[k] - 0.2f) << "texel " << i;
      EXPECT_LE(texture.texels[i][k], high[k] + 0.2f) << "texel " << i;
    }
    const bool inside_hole = i + 1 < texture.texels.size() && field.importance[0][i] < kHole && field.importance[0][i + 1] < kHole;
    if (!inside_hole || static_cast<int>(i + 1) % texture.width == 0) continue;
    EXPECT_LT(glm::length(texture.texels[i + 1] - texture.texels[i]), 0.15f) << "texel " << i;
  }
}

TEST_F(InferenceTest, AnObjectThatNoLightReachesIsNamedInAWarning) {
  EXPECT_THAT(inference.warnings, ::testing::IsEmpty());
  Truth dark = smooth_truth();
  const auto lit = dark.diffuse;
  dark.diffuse = [lit](int object, glm::vec2 uv, int lamp) { return object == 1 ? glm::vec3(0) : lit(object, uv, lamp); };
  ScratchStore store;
  const auto keys = draw_frames(*scene, dark, kSmall, *gpu, store.store());
  const Inference result = infer_textures(*scene, keys, store.store(), *gpu, kSmall, silent_progress());
  EXPECT_THAT(result.warnings, ::testing::ElementsAre(::testing::HasSubstr("\"" + scene->objects[1].name + "\"")));
}

TEST_F(InferenceTest, ImportanceSumsToThePixelsOfTheObject) {
  double screen = 0, texels = 0;
  for (const StoreKey& key : frames) {
    const Frame frame = load(work->store(), key, *scene);
    for (const float c : frame.objects[0].coverage) screen += static_cast<double>(c) / 8;
  }
  for (const float i : inference.fields[0].importance[0]) texels += static_cast<double>(i);
  EXPECT_NEAR(texels / screen, 1, 0.02);
}

TEST_F(InferenceTest, ASecondRunFindsEverythingInTheStore) {
  struct Count final : Progress {
    int64_t total = 0, found = 0;
    void begin(const char*, int64_t all, int64_t already, const char*) override { total = all, found = already; }
    void advance(int64_t) override {}
    void end() override {}
  } count;
  const Inference second = infer_textures(*scene, frames, work->store(), *gpu, kSmall, count);
  EXPECT_EQ(count.total, 12);
  EXPECT_EQ(count.found, 12);
  for (size_t f = 0; f < inference.fields.size(); ++f) EXPECT_EQ(inference.fields[f].importance, second.fields[f].importance);
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
  const auto whole = all_textures(work->store(), inference);
  for (const int64_t steps : {0, 3, 9}) {
    const auto other = fresh_store();
    Impatient impatient(steps);
    EXPECT_THROW(infer_textures(*scene, frames, other->store(), *gpu, kSmall, impatient), Interrupted);
    EXPECT_TRUE(all_textures(other->store(), infer(other->store())) == whole) << "after " << steps << " textures";
  }
}

TEST_F(InferenceTest, OneThreadGivesTheSameBytesAsFour) {
  const auto run = [&](size_t threads) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const auto other = fresh_store();
    return all_textures(other->store(), infer(other->store()));
  };
  EXPECT_TRUE(run(1) == run(4));
}

// So many rows on so few texels that matrices are summed up (data_term.h): the bytes must not depend on threads or interruptions
// there either.
TEST_F(InferenceTest, LayersThatManyViewsSeeDrawTheFramesAgainAndAreTheSameBytesHoweverTheyCameAbout) {
  const auto orbit = make_ball_on_board({.views = 12, .lamps = 1});
  const Truth truth = smooth_truth();
  ScratchStore store;
  InferenceOptions coarse = kSmall;
  coarse.fit.texels_per_pixel = 0.6f;
  const auto keys = draw_frames(*orbit, truth, coarse, *gpu, store.store());
  const Inference result = infer_textures(*orbit, keys, store.store(), *gpu, coarse, silent_progress());
  for (const int64_t sample : {0, 5, 11}) {
    const auto drawn = draw_inferred(store.store(), *orbit, result, kLayers, coarse, *gpu, sample);
    EXPECT_GT(psnr(drawn, load(store.store(), keys[static_cast<size_t>(sample)], *orbit).combined), 33) << "sample " << sample;
  }
  tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  ScratchStore other;
  for (const StoreKey& key : keys) other.store().save_frame(key, *orbit, load(store.store(), key, *orbit));
  Impatient impatient(4);
  EXPECT_THROW(infer_textures(*orbit, keys, other.store(), *gpu, coarse, impatient), Interrupted);
  const Inference again = infer_textures(*orbit, keys, other.store(), *gpu, coarse, silent_progress());
  EXPECT_TRUE(all_textures(other.store(), again) == all_textures(store.store(), result));
}

// What the target shows at a position that is no sample: the textures of the nearest one, on exact geometry.
std::vector<glm::vec3> draw_nearest(const Scene& scene, const Store& store, const Inference& inference, hal::Gpu& gpu,
                                    const Position& position) {
  TestRenderer renderer(gpu, kSmall, inference.objects);
  const int64_t sample = scene.space().flat_from_index(scene.space().nearest_sample(position));
  std::vector<std::vector<LaidTexture>> textures;
  for (size_t i = 0; i < inference.objects.size(); ++i)
    textures.push_back(load_object_textures(store, scene, inference, kLayers, static_cast<int>(i), sample));
  const float aspect = static_cast<float>(kSmall.width) / static_cast<float>(kSmall.height);
  const auto samples = draw_textures(renderer, geometry_state_at(scene, position, inference.objects, aspect), textures);
  std::vector<glm::vec3> picture;
  for (const glm::vec4& pixel : resolve_linear(samples, kSmall.width, kSmall.height, kSmall.supersampling))
    picture.emplace_back(pixel);
  return picture;
}

// A scene with frames at its grid samples and between them.
class BetweenSamplesTest : public InferenceTest {
 protected:
  BetweenSamplesTest() {
    for (int64_t i = 0; i < orbit->space().sample_count(); ++i)
      positions.push_back(orbit->space().position_of(orbit->space().index_from_flat(i)));
    grid = positions.size();
    for (const BetweenSample& between : between_samples(*orbit)) positions.push_back(between.position);
    // Light that stays on the surface but is not known to: every view has textures of its own, and some of the board is hidden.
    Truth truth = smooth_truth();
    truth.specular = [diffuse = truth.diffuse](int object, glm::vec2 uv, float, int lamp) { return diffuse(object, uv, lamp); };
    truth.diffuse = [](int, glm::vec2, int) { return glm::vec3(0); };
    keys = draw_frames_at(*orbit, truth, positions, kSmall, *gpu, store.store());
  }
  std::vector<StoreKey> grid_keys() const { return {keys.begin(), keys.begin() + static_cast<ptrdiff_t>(grid)}; }
  Inference infer_from(const std::vector<StoreKey>& frame_keys, const Store& where) const {
    return infer_textures(*orbit, frame_keys, where, *gpu, kSmall, silent_progress());
  }
  // Decibels of what is shown at position number i.
  double quality(const Inference& result, size_t i) {
    return psnr(draw_nearest(*orbit, store.store(), result, *gpu, positions[i]), load(store.store(), keys[i], *orbit).combined);
  }

  std::unique_ptr<Scene> orbit = make_ball_on_board({.views = 6, .lamps = 2});  // more states than are read at once
  ScratchStore store;
  std::vector<Position> positions;
  size_t grid = 0;
  std::vector<StoreKey> keys;
};

TEST_F(BetweenSamplesTest, WhatComesIntoViewHalfWayIsDrawnRight) {
  const Inference plain = infer_from(grid_keys(), store.store()), both = infer_from(keys, store.store());
  ASSERT_EQ(both.fields.size(), 2u);
  for (size_t i = 0; i < positions.size(); ++i) {
    const double without = quality(plain, i), with = quality(both, i);
    EXPECT_GT(with, i < grid ? without - 1 : without + 3) << (i < grid ? "sample " : "half-way, number ") << i;
  }
}

TEST_F(BetweenSamplesTest, TheSameBytesHoweverTheyCameAbout) {
  const Inference result = infer_from(keys, store.store());
  tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  ScratchStore other;
  for (const StoreKey& key : keys) other.store().save_frame(key, *orbit, load(store.store(), key, *orbit));
  for (const int64_t steps : {1, 7}) {
    Impatient impatient(steps);
    EXPECT_THROW(infer_textures(*orbit, keys, other.store(), *gpu, kSmall, impatient), Interrupted);
  }
  const Inference again = infer_from(keys, other.store());
  EXPECT_TRUE(all_textures(other.store(), again) == all_textures(store.store(), result));
  for (size_t f = 0; f < result.fields.size(); ++f) EXPECT_EQ(again.fields[f].importance, result.fields[f].importance);
}

TEST_F(InferenceTest, PixelsThatAreNoNumbersSpoilNoTexture) {
  ScratchStore store;
  std::vector<StoreKey> keys = frames;
  for (size_t i = 0; i < keys.size(); ++i) {
    Frame frame = load(work->store(), keys[i], *scene);
    for (ObjectFrame& o : frame.objects)
      for (size_t p = 7 * i; p < o.coverage.size(); p += 97) {
        o.diffuse[p] = glm::vec3(p % 2 ? NAN : INFINITY);
        if (p % 3 == 0) o.specular[p].y = NAN;
        if (p % 5 == 0) o.coverage[p] = NAN;
      }
    keys[i].low ^= 0x5555;
    store.store().save_frame(keys[i], *scene, frame);
  }
  const Inference result = infer_textures(*scene, keys, store.store(), *gpu, kSmall, silent_progress());
  ASSERT_EQ(result.fields.size(), inference.fields.size());
  for (const auto& texture : all_textures(store.store(), result))
    for (const glm::vec3& texel : texture) ASSERT_TRUE(std::isfinite(texel.x + texel.y + texel.z) && texel.x < 2);
  for (const Field& field : result.fields)
    for (const std::vector<float>& own : field.importance)
      for (const float i : own) ASSERT_TRUE(std::isfinite(i));
  for (const int64_t sample : {0, 5}) {
    const auto drawn = draw_inferred(store.store(), *scene, result, kLayers, kSmall, *gpu, sample);
    EXPECT_GT(psnr(drawn, load(work->store(), frames[static_cast<size_t>(sample)], *scene).combined), 35) << "sample " << sample;
  }
}

TEST_F(InferenceTest, AnObjectWithoutPixelsInSomeFramesGetsTexturesAllTheSame) {
  ScratchStore store;
  std::vector<StoreKey> keys = frames;
  for (size_t i = 0; i < keys.size(); ++i) {
    Frame frame = load(work->store(), keys[i], *scene);
    if (i < 2) frame.objects.erase(frame.objects.begin());
    if (i == 2) frame.objects[0] = {0, 0, 0, 0, 0, {}, {}, {}};
    if (i == 3) std::fill(frame.objects[0].coverage.begin(), frame.objects[0].coverage.end(), 0.0f);
    keys[i].low ^= 0xaaaa;
    store.store().save_frame(keys[i], *scene, frame);
  }
  const Inference result = infer_textures(*scene, keys, store.store(), *gpu, kSmall, silent_progress());
  for (const auto& texture : all_textures(store.store(), result))
    for (const glm::vec3& texel : texture) ASSERT_TRUE(std::isfinite(texel.x + texel.y + texel.z));
}

TEST_F(InferenceTest, AMissingFrameIsAnErrorThatNamesIt) {
  std::vector<StoreKey> wrong = frames;
  wrong[5].low ^= 1;
  try {
    infer_textures(*scene, wrong, work->store(), *gpu, kSmall, silent_progress());
    FAIL() << "no error";
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find(wrong[5].hex()), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace vitrine::testing
