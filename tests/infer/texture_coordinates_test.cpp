// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/texture_coordinates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <random>

#include "host/base/field_blocks.h"
#include "host/infer/geometry_states.h"
#include "host/infer/parameterization.h"
#include "host/infer/texture_layout.h"
#include "tests/infer/test_scene.h"

namespace vitrine::testing {
namespace {

const std::vector<DomainPart> kOnePatch{VisibleSurface::kWholeDomain};

glm::mat2 turned(float angle) { return {std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle)}; }

// Places under a grid over a part of the domain, all stretched alike: `pixels_per_uv` maps steps in the domain to the screen.
VisibleSurface flat_surface(const glm::vec2& low, const glm::vec2& high, const glm::mat2& pixels_per_uv) {
  VisibleSurface surface;
  std::vector<VisibleSurface::CellRow> rows(VisibleSurface::kCells);
  constexpr int n = 200;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const glm::vec2 at = low + (glm::vec2(i, j) + 0.5f) / float{n} * (high - low), uv = at - glm::floor(at);
      surface.add_sample({uv, glm::inverse(pixels_per_uv)});
      const glm::ivec2 cell(uv * float{VisibleSurface::kCells});
      rows[static_cast<size_t>(cell.y)].set(static_cast<size_t>(cell.x));
      surface.meet(uv - 1e-4f, uv + 1e-4f);
    }
  for (int row = 0; row < VisibleSurface::kCells; ++row) surface.see(row, rows[static_cast<size_t>(row)]);
  return surface;
}

TEST(TextureCoordinates, TheGradientOfTheIsometryErrorIsThatOfFiniteDifferences) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> any(-0.02f, 0.02f);
  std::vector<SurfaceSample> samples(50);
  for (SurfaceSample& s : samples) s.uv_per_pixel = {any(random), any(random), any(random), any(random)};
  const glm::dmat2 at(60, 12, -20, 90);
  glm::dmat2 gradient;
  isometry_error(samples, at, &gradient);
  for (int c = 0; c < 2; ++c)
    for (int r = 0; r < 2; ++r) {
      glm::dmat2 above = at, below = at;
      above[c][r] += 1e-4;
      below[c][r] -= 1e-4;
      const double slope = (isometry_error(samples, above, nullptr) - isometry_error(samples, below, nullptr)) / 2e-4;
      EXPECT_NEAR(gradient[c][r], slope, 1e-4 * std::fabs(slope) + 1e-6) << c << r;
    }
}

// Where the whole surface is stretched alike there is a perfect isometry, but for a turn.
TEST(TextureCoordinates, AnEvenlyStretchedSurfaceGetsAnIsometry) {
  for (const glm::mat2& pixels_per_uv : {glm::mat2(300, 0, 0, 90), turned(0.7f) * glm::mat2(120, 30, -10, 400)}) {
    const VisibleSurface surface = flat_surface({0.1f, 0.2f}, {0.6f, 0.9f}, pixels_per_uv);
    const glm::mat2 map = most_isometric_map(surface.samples()), texels_per_pixel = map * glm::inverse(pixels_per_uv);
    for (const float angle : {0.0f, 0.5f, 1.0f, 2.0f})
      EXPECT_NEAR(glm::length(texels_per_pixel * glm::vec2(std::cos(angle), std::sin(angle))), 1, 0.01);
  }
}

TEST(TextureCoordinates, NoTexelIsStretchedBeyondTheBound) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> any(0, 1);
  VisibleSurface surface = flat_surface({0, 0}, {1, 1}, glm::mat2(200, 0, 0, 200));
  for (int i = 0; i < 20000; ++i) {  // some of it larger, at a slant
    const glm::mat2 pixels = turned(0.6f) * glm::mat2(200 + 900 * any(random), 0, 0, 150) * turned(-0.6f);
    surface.add_sample({{any(random), any(random)}, glm::inverse(pixels)});
  }
  for (const float share : {1.0f, 0.9f}) {
    const TextureFit fit = fit_texture(surface, {.stretch_bound = 1.25f, .stretch_share = share});
    size_t beyond = 0;
    for (const SurfaceSample& s : surface.samples()) {
      const glm::mat2 pixels = glm::inverse(fit.linear * s.uv_per_pixel);
      float largest = 0;
      for (int k = 0; k < 90; ++k) {
        const float angle = std::numbers::pi_v<float> * static_cast<float>(k) / 90;
        largest = std::max(largest, glm::length(pixels * glm::vec2(std::cos(angle), std::sin(angle))));
      }
      beyond += largest > 1.25f * 1.01f;
    }
    EXPECT_LE(beyond, (1.005f - share) * static_cast<float>(surface.samples().size())) << share;
  }
}

TEST(TextureCoordinates, WhatTheSeamDividesIsMadeWhole) {
  const glm::mat2 pixels_per_uv(400, 0, 0, 200);
  const VisibleSurface across = flat_surface({0.7f, 0.1f}, {1.3f, 0.9f}, pixels_per_uv);
  EXPECT_NEAR(branch_cut(across, 0), 0.5f, 0.01f);
  EXPECT_EQ(branch_cut(across, 1), 0);
  const TextureFit fit = fit_texture(across, {}),
                   whole = fit_texture(flat_surface({0.2f, 0.1f}, {0.8f, 0.9f}, pixels_per_uv), {});
  EXPECT_NEAR(fit.size.x * fit.size.y, whole.size.x * whole.size.y, 0.03f * whole.size.x * whole.size.y);
  // Both sides of the seam lie side by side.
  const PatchMap map = map_of(fit, {{0, 0}, {512, 512}}, {512, 512});
  EXPECT_NEAR(glm::length(map({1, 0.5f}) - map({0, 0.5f})), 0, 1e-5f);
  EXPECT_LT(glm::length(map({0.99f, 0.5f}) - map({0.01f, 0.5f})), 0.04f);
}

TEST(TextureCoordinates, ASlantedStripGetsASlantedRectangle) {
  std::vector<glm::vec2> points;
  for (int i = 0; i <= 100; ++i)
    for (int j = 0; j <= 10; ++j) points.push_back(turned(0.6f) * glm::vec2(i, j));
  const Rectangle rectangle = smallest_rectangle(points);
  glm::vec2 low(1e9f), high(-1e9f);
  for (const glm::vec2& p : points)
    low = glm::min(low, turned(rectangle.turn) * p), high = glm::max(high, turned(rectangle.turn) * p);
  EXPECT_NEAR((high - low).x, 100, 1);
  EXPECT_NEAR((high - low).y, 10, 1);
  EXPECT_NEAR(rectangle.size.x, 100, 1);
  EXPECT_NEAR(smallest_rectangle(points, 5).texels, 100 * 20, 100);
}

TEST(TextureCoordinates, ItFillsTheSlotThatItGets) {
  TextureFit fit;
  fit.linear = glm::mat2(900, 0, 0, 50);
  fit.low = {90, 5};
  fit.size = {720, 40};
  const PatchMap map = map_of(fit, {{20, 4}, {100, 30}}, {128, 64});
  EXPECT_NEAR(glm::distance(map({0.1f, 0.1f}) * glm::vec2(128, 64), glm::vec2(20, 4)), 0, 1e-3f);
  EXPECT_NEAR(glm::distance(map({0.9f, 0.9f}) * glm::vec2(128, 64), glm::vec2(120, 34)), 0, 1e-3f);
}

class SurveyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    gpu = make_gpu();
    ASSERT_NE(gpu, nullptr);
    scene = make_ball_on_board({.views = 20, .lamps = 2});
    const Pose pose = pose_scene(*scene, {});
    for (int i = 0; i < 2; ++i) objects.push_back(make_drawn_object(*scene, i, world_from_object(*scene, pose, i)));
    geometry = make_geometry_states(*scene, geometry_axes(*scene), objects, 4.0f / 3);
    surfaces = survey_surfaces(*gpu, options, objects, geometry.states);
  }
  InferenceOptions options{.width = 80, .height = 60};
  std::unique_ptr<hal::Gpu> gpu;
  std::unique_ptr<Scene> scene;
  std::vector<DrawnObject> objects;
  GeometryStates geometry;
  std::vector<std::vector<VisibleSurface>> surfaces;
};

// Coordinates as the device interpolates them, and their change to the neighbours within the object.
TEST_F(SurveyTest, PlacesAndTheirChangeAreWhatTheDeviceInterpolates) {
  TestRenderer renderer(*gpu, options, objects);
  const Pyramid pyramid(1, 1);
  std::vector<hal::Texture> textures;
  for (size_t i = 0; i < 2; ++i) {
    const glm::vec4 texel(0, 0, 0, i + 1);
    textures.push_back(create_pyramid_texture(*gpu, renderer.drawer(), pyramid, hal::TextureFormat::kRgba32f,
                                              std::as_bytes(std::span(&texel, 1))));
  }
  std::vector<glm::vec4> pixels(static_cast<size_t>(renderer.width() * renderer.height()));
  renderer.render_coordinates(geometry.states[3], textures, 0, pixels);
  for (size_t object = 0; object < 2; ++object) {
    ASSERT_GT(surfaces[3][object].samples().size(), 300u);
    size_t near = 0, along = 0;
    for (const SurfaceSample& s : surfaces[3][object].samples()) {
      for (size_t i = 0; i + 1 < pixels.size(); ++i) {
        if (static_cast<size_t>(pixels[i].w) != object + 1 || glm::length(glm::vec2(pixels[i]) - s.uv) > 1e-5f) continue;
        ++near;
        // A supersample is half a pixel.
        const glm::vec2 step = glm::vec2(pixels[i + 1]) - glm::vec2(pixels[i]), expected = 0.5f * s.uv_per_pixel[0];
        along += glm::length(step - expected) < 0.1f * glm::length(expected);
        break;
      }
    }
    EXPECT_GT(near, 0.99 * static_cast<double>(surfaces[3][object].samples().size())) << object;
    EXPECT_GT(along, 0.8 * static_cast<double>(near)) << object;  // but for silhouettes and edges
  }
  for (const hal::Texture texture : textures) gpu->destroy(texture);
}

// 214 wires, each a supersample wide, none of them in a column that samples are taken from.
TEST(TextureCoordinates, AFenceThatSlipsThroughTheStrideIsFitted) {
  const InferenceOptions options{.width = 640, .height = 480};
  auto gpu = make_gpu();
  ASSERT_NE(gpu, nullptr);
  std::vector<DrawnObject> fence(1);
  for (int column = 1; column < 1280; column += 6) {
    const float left = static_cast<float>(column) / 640 - 1, right = static_cast<float>(column + 1) / 640 - 1;
    const float u = static_cast<float>(column) / 1280;
    const auto first = static_cast<uint32_t>(fence[0].vertices.size());
    for (const MeshVertex& v : {MeshVertex{left, -1, 0, u, 0}, MeshVertex{right, -1, 0, u + 1.0f / 1280, 0},
                                MeshVertex{right, 1, 0, u + 1.0f / 1280, 1}, MeshVertex{left, 1, 0, u, 1}})
      fence[0].vertices.push_back(v);
    for (const uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u}) fence[0].indices.push_back(first + corner);
  }
  const std::vector<GeometryState> states{{{glm::mat4(1)}, {0}, {}}};
  const auto surfaces = survey_surfaces(*gpu, options, fence, states);
  ASSERT_TRUE(surfaces[0][0].visible());
  ASSERT_FALSE(surfaces[0][0].samples().empty());
  EXPECT_GT(fit_texture(surfaces[0][0], {}).size.x, 0);
}

Field field_of(const Scene& scene, AxisMask axes) {
  Field field;
  field.axes = axes;
  field.space = scene.space().restricted(axes);
  field.block_size = block_size_of(field.space);
  field.stagger = {3};
  return field;
}

TEST_F(SurveyTest, ABlockHoldsWhatItsSamplesAndTheirNeighboursShow) {
  const ParameterSpace space = scene->space();
  Field field = field_of(*scene, 3);
  const auto blocks = states_of_blocks(geometry.table, space, field);  // views 0..4, 5..12, 13..19; each lamp by itself
  ASSERT_EQ(blocks.size(), 6u);
  EXPECT_EQ(blocks[0], (std::vector<int>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(blocks[1], blocks[0]);
  EXPECT_EQ(blocks[2].front(), 4);
  EXPECT_EQ(blocks[2].back(), 13);
  std::vector<const VisibleSurface*> own;
  for (const auto& state : surfaces) own.push_back(&state[0]);
  lay_out(geometry.table, space, own, kOnePatch, {}, field);
  ASSERT_EQ(field.maps.size(), 3u);  // alike for both lamps
  for (int64_t sample = 0; sample < field.space.sample_count(); ++sample) {
    const int view = field.space.index_from_flat(sample)[0];
    for (const int state : {view - 1, view, view + 1}) {
      if (state < 0 || state >= 20) continue;
      for (const SurfaceSample& s : own[static_cast<size_t>(state)]->samples()) {
        const glm::vec2 at = map_of(field, sample)(s.uv);
        ASSERT_TRUE(at.x > 0 && at.x < 1 && at.y > 0 && at.y < 1) << "sample " << sample << ", state " << state;
      }
    }
  }
}

TEST_F(SurveyTest, ABlockNeedsFewerTexelsThanAllViewsTogether) {
  std::vector<const VisibleSurface*> own;
  for (const auto& state : surfaces) own.push_back(&state[0]);
  Field blocks = field_of(*scene, 3), whole = field_of(*scene, 2);
  whole.stagger = {};
  lay_out(geometry.table, scene->space(), own, kOnePatch, {}, blocks);
  lay_out(geometry.table, scene->space(), own, kOnePatch, {}, whole);
  EXPECT_EQ(whole.maps.size(), 1u);
  EXPECT_LT(blocks.texture_width * blocks.texture_height, whole.texture_width * whole.texture_height);
}

TEST_F(SurveyTest, WhereSamplesAreBlendedAllBlocksLieAlike) {
  std::vector<const VisibleSurface*> own;
  for (const auto& state : surfaces) own.push_back(&state[0]);
  Field field = field_of(*scene, 3);
  lay_out(geometry.table, scene->space(), own, kOnePatch, {.one_map = true}, field);
  EXPECT_EQ(field.maps.size(), 1u);
  EXPECT_TRUE(field.block_maps.empty());
}

}  // namespace
}  // namespace vitrine::testing
