// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/inference_quality.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>

#include "formats/color.h"
#include "host/base/error.h"
#include "host/bench/filling.h"
#include "host/bench/forward_mapping.h"
#include "host/bench/frozen_scene.h"
#include "host/bench/traced_textures.h"
#include "host/infer/parameterization.h"
#include "host/trace/tracer.h"

namespace vitrine::test {
namespace {

constexpr int kImageSize = 64, kTextureSize = 32, kPictureSize = 64;

// A picture without symmetry: what is turned, mirrored or transposed shows.
Image waves() {
  Image image{"waves", kImageSize, kImageSize, {}};
  for (int y = 0; y < kImageSize; ++y)
    for (int x = 0; x < kImageSize; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / kImageSize, v = (static_cast<float>(y) + 0.5f) / kImageSize;
      const auto byte = [](float value) { return static_cast<uint8_t>(std::lround(255 * value)); };
      const float turn = 2 * std::numbers::pi_v<float>;
      image.rgba.insert(image.rgba.end(),
                        {byte(0.2f + 0.6f * u), byte(0.8f - 0.5f * v), byte(0.5f + 0.3f * std::sin(turn * (u + 0.5f * v))), 255});
    }
  return image;
}

// An unlit textured square that fills four fifths of the height of a square picture, seen from slightly aside.
std::unique_ptr<Scene> make_square() {
  auto scene = std::make_unique<Scene>();
  scene->nodes.resize(2);
  scene->nodes[1].translation = {0.3f, 0.2f, 4};
  scene->nodes[1].rotation = glm::angleAxis(0.07f, glm::vec3(0, 1, 0));
  scene->camera.node = 1;
  scene->camera.yfov = 2 * std::atan(1.25f / 4);
  scene->images.push_back(waves());
  Material material;
  material.unlit = true;
  material.base_color_texture.image = 0;
  scene->materials.push_back(material);
  Object square;
  square.name = "square";
  for (const glm::vec2 corner : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
    square.geometry.positions.emplace_back(2 * corner.x - 1, 1 - 2 * corner.y, 0);
    square.geometry.normals.emplace_back(0, 0, 1);
    square.geometry.texcoords[0].push_back(corner);
  }
  square.geometry.indices = {0, 3, 2, 0, 2, 1};
  square.geometry.triangle_materials = {0, 0};
  scene->objects.push_back(square);
  scene->settings.width = scene->settings.height = kPictureSize;
  return scene;
}

DrawnObject drawn_square(const Scene& scene) {
  return make_drawn_object(scene, 0, glm::mat4(1));
}
constexpr Placement kWhole{{kTextureSize, kTextureSize}, {}};

// The largest difference, in 8-bit codes, of a texture and the square's image at its texels but for `margin` at the border.
double difference_from_image(const LinearTexture& texture, const Image& image, int margin) {
  double largest = 0;
  const int step = kImageSize / kTextureSize;
  for (int y = margin; y < kTextureSize - margin; ++y)
    for (int x = margin; x < kTextureSize - margin; ++x)
      for (int c = 0; c < 3; ++c) {
        double mean = 0;  // of the image's texels under this one
        for (int k = 0; k < step * step; ++k) {
          const int u = step * x + k % step, v = step * y + k / step;
          mean += image.rgba[static_cast<size_t>(4 * (v * kImageSize + u) + c)] / static_cast<double>(step * step);
        }
        const float texel = texture.texels[static_cast<size_t>(y * kTextureSize + x)][c];
        largest = std::max(largest, std::fabs(255 * srgb_from_linear(static_cast<double>(texel)) - mean));
      }
  return largest;
}

glm::mat4 clip_from_square(const Scene& scene) {
  return clip_from_camera(scene.camera, 1) * glm::inverse(pose_scene(scene, {}).world_from_camera);
}

TEST(ForwardMapping, AConstantLayerMakesAConstantTexture) {
  const auto scene = make_square();
  PartialPicture layers{kPictureSize, kPictureSize, std::vector<glm::vec3>(kPictureSize * kPictureSize, glm::vec3(9)), {}};
  for (int i = 0; i < kPictureSize * kPictureSize; ++i) {
    const int x = i % kPictureSize, y = i / kPictureSize;
    const bool hidden = x > 30 && y < 20;  // by something else, in front
    layers.defined.push_back(x >= 6 && x < 58 && y >= 6 && y < 58 && !hidden);
    if (layers.defined.back()) layers.values[static_cast<size_t>(i)] = {0.25f, 0.5f, 0.75f};
  }
  const LinearTexture texture = map_forward(drawn_square(*scene), kWhole, clip_from_square(*scene), layers);
  ASSERT_EQ(texture.texels.size(), static_cast<size_t>(kTextureSize * kTextureSize));
  for (const glm::vec3& texel : texture.texels)
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(texel[c], 0.25f * static_cast<float>(c + 1), 1e-5f);
}

TEST(ForwardMapping, ATextureEqualsTheSquareInItsPicture) {
  const auto scene = make_square();
  const Frame frame = Tracer(*scene).render({}, {kPictureSize, kPictureSize, 64});
  const LinearTexture texture = map_forward(drawn_square(*scene), kWhole, clip_from_square(*scene), object_layers(frame, 0, 1));
  EXPECT_LT(difference_from_image(texture, scene->images[0], 3), 4);
}

TEST(TracedTextures, ATextureOfAnUnlitSquareEqualsItsImage) {
  const auto scene = make_square();
  const LinearTexture texture = TextureTracer(*scene).trace(drawn_square(*scene), kWhole, {kPictureSize, kPictureSize, 9});
  EXPECT_LT(difference_from_image(texture, scene->images[0], 2), 4);
}

TEST(TracedTextures, WhatStandsInFrontOfASurfaceAndWhichWayItFacesDoNotMatter) {
  const auto scene = make_square();
  const LinearTexture free = TextureTracer(*scene).trace(drawn_square(*scene), kWhole, {kPictureSize, kPictureSize, 9});
  scene->nodes[1].translation.z = -4;  // the camera behind the square
  scene->nodes[1].rotation = glm::angleAxis(3.07f, glm::vec3(0, 1, 0));
  scene->nodes.emplace_back().translation = {0, 0, -1};
  Object cover = scene->objects[0];
  cover.name = "cover";
  cover.node = 2;
  scene->materials.emplace_back().double_sided = true;
  cover.geometry.triangle_materials = {1, 1};
  scene->objects.push_back(cover);
  const LinearTexture covered = TextureTracer(*scene).trace(drawn_square(*scene), kWhole, {kPictureSize, kPictureSize, 9});
  for (size_t i = 0; i < free.texels.size(); ++i)
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(free.texels[i][c], covered.texels[i][c], 0.02f) << i;
}

TEST(Filling, ReflectionTakesWhatLiesAsFarBehindTheEdge) {
  PartialPicture row{8, 1, {}, {1, 1, 1, 1, 0, 0, 0, 0}};
  for (int x = 0; x < 8; ++x) row.values.emplace_back(x);
  const std::vector<glm::vec3> filled = fill_by_reflection(row);
  for (int x = 4; x < 7; ++x) EXPECT_EQ(filled[static_cast<size_t>(x)].x, 6 - x);
  EXPECT_EQ(filled[7].x, 3);  // nothing lies that far behind
  EXPECT_EQ(filled[2].x, 2);
}

TEST(FrozenScene, StandsStillWhereTheAxesPutIt) {
  const auto scene = load_scene(VITRINE_SOURCE_DIR "/tests/scenes/table");
  const Position middle = middle_position(*scene);
  const auto between = half_step_on(*scene, middle);
  ASSERT_TRUE(between);
  EXPECT_NEAR((*between)[0] - middle[0], 0.5f / 63, 1e-6f);  // 64 views
  EXPECT_EQ((*between)[1], middle[1]);                       // the lamp moves no camera
  const Scene frozen = frozen_at(*scene, *between);
  EXPECT_EQ(frozen.space().sample_count(), 1);
  const Pose still = pose_scene(frozen, {}), moved = pose_scene(*scene, *between);
  EXPECT_EQ(still.world_from_camera, moved.world_from_camera);
  EXPECT_EQ(still.world_from_node, moved.world_from_node);
}

InferenceQuality measure_table(const std::string& object) {
  std::string folder = (std::filesystem::temp_directory_path() / "vitrine-bench-XXXXXX").string();
  EXPECT_NE(mkdtemp(folder.data()), nullptr);
  const auto scene = load_scene(VITRINE_SOURCE_DIR "/tests/scenes/table");
  scene->settings.width = 80;
  scene->settings.height = 60;
  InferenceQualityOptions options{.samples_per_pixel = 4, .object = object, .filters = {SurfaceFilter::kTrilinear}};
  const InferenceQuality quality = measure_inference(*scene, options, Store(folder), silent_progress());
  std::filesystem::remove_all(folder);
  return quality;
}

TEST(InferenceQuality, LeastSquaresReproduceTheSampleBetterThanTheirPeers) {
  const InferenceQuality quality = measure_table("cup");
  const auto at_sample = [&](TextureMethod method) {
    return std::find_if(quality.rows.begin(), quality.rows.end(),
                        [&](const QualityRow& r) { return r.method == method && r.where == "at"; })
        ->psnr_db;
  };
  EXPECT_EQ(quality.rows.size(), 15u);
  EXPECT_GT(at_sample(TextureMethod::kLeastSquares), at_sample(TextureMethod::kForward) + 2);
  EXPECT_GT(at_sample(TextureMethod::kLeastSquares), at_sample(TextureMethod::kTraced) + 3);
  for (const QualityRow& row : quality.rows) EXPECT_EQ(row.object, "cup");
  ASSERT_EQ(quality.matrices.size(), 1u);
  const std::vector<MatrixCost>& costs = quality.matrices[0].costs;
  ASSERT_EQ(costs.size(), 4u);
  EXPECT_EQ(costs[1].method, "coordinates");
  EXPECT_LT(costs[1].renderings, costs[0].renderings);
  for (const MatrixCost& cost : costs) {
    const bool floats = cost.method != "eight_bit";
    EXPECT_LE(cost.difference, floats ? 2e-5f : 2.0f / 255) << cost.method;
    EXPECT_LE(cost.rendering_difference, floats ? 2e-5f : 2.0f / 255) << cost.method;
    EXPECT_LE(cost.row_sum_error, 1e-3f) << cost.method;
  }
}

TEST(InferenceQuality, AnUnknownObjectIsRefusedBeforeAnythingIsTraced) { EXPECT_THROW(measure_table("teapot"), InputError); }

}  // namespace
}  // namespace vitrine::test
