// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Surfaces drawn texel on pixel, against what each pixel must then be.
#include "target/draw/scene_drawer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "formats/companding.h"
#include "hal/backends.h"
#include "target/mip.h"

namespace vitrine {
namespace {

constexpr int kWidth = 32, kHeight = 24;

// Multiples of 1/64 below 2: exact as halves, and so are sums of a few.
float texel(int seed, int x, int y, int channel) {
  return static_cast<float>((17 * x + 29 * y + 41 * channel + seed) % 128) / 64;
}

struct Drawn {
  std::unique_ptr<hal::Gpu> gpu = std::move(hal::create_osmesa_gpu(kWidth, kHeight).value());
  SceneDrawer drawer;
  float raise_of_right;  // of its mesh coordinates, in u

  explicit Drawn(int max_textures = 2, float raise = 0) : raise_of_right(raise) {
    auto made = SceneDrawer::create(*gpu, {.width = kWidth,
                                           .height = kHeight,
                                           .supersampling = 1,
                                           .target_format = hal::TextureFormat::kRgba32f,
                                           .max_textures = max_textures});
    EXPECT_TRUE(made.ok()) << made.status().detail();
    drawer = made.value();
  }

  // Texels of the finest level are color(x, y, channel); nothing may show the others.
  template <typename Color>
  hal::Texture texture(int width, int height, const Color& color) {
    const hal::Texture made = drawer.create_texture(width, height, hal::TextureFormat::kRgba16f).value();
    for (int level = 0, w = width, h = height; level < mip_level_count(width, height);
         ++level, w = mip_size(w), h = mip_size(h)) {
      std::vector<uint16_t> texels;
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
          for (int c = 0; c < 3; ++c) texels.push_back(half_from_float(level == 0 ? color(x, y, c) : 1000.0f));
          texels.push_back(half_from_float(1));
        }
      EXPECT_TRUE(gpu->update_texture(made, level, 0, 0, w, h, std::as_bytes(std::span(texels))).ok());
    }
    return made;
  }

  // The picture's left half and its right half, whose mesh coordinates together go from (0, 0) to (1, 1), but for the raise.
  DrawMesh halves() {
    const float seam = std::nextafter(0.5f, 0.0f), r = raise_of_right;
    const std::vector<MeshVertex> vertices{{-1, -1, 0, 0, 0},   {0, -1, 0, seam, 0},     {0, 1, 0, seam, 1},
                                           {-1, 1, 0, 0, 1},    {0, -1, 0, 0.5f + r, 0}, {1, -1, 0, 1 + r, 0},
                                           {1, 1, 0, 1 + r, 1}, {0, 1, 0, 0.5f + r, 1}};
    const std::vector<uint32_t> indices{0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
    return drawer.create_mesh(vertices, indices, 12).value();
  }

  std::vector<float> picture(std::initializer_list<SurfaceTexture> textures) {
    std::vector<float> rgba(4 * kWidth * kHeight);
    EXPECT_TRUE(drawer.begin().ok());
    const Status drawn = drawer.draw(halves(), glm::mat4(1), false, textures);
    EXPECT_TRUE(drawn.ok()) << drawn.detail();
    EXPECT_TRUE(drawer.end().ok());
    EXPECT_TRUE(
        gpu->read_pixels(drawer.supersampled(), hal::TextureFormat::kRgba32f, std::as_writable_bytes(std::span(rgba))).ok());
    return rgba;
  }
};

template <typename Color>
void expect_picture(const std::vector<float>& rgba, const Color& color) {
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(rgba[static_cast<size_t>(4 * (y * kWidth + x) + c)], color(x, y, c), 2e-3) << x << ' ' << y << ' ' << c;
}

// A whole texture, and the middle of a larger one that lies turned by a right angle.
TEST(SceneDrawer, TexturesOfASurfaceAddEachWhereItsMapLaysIt) {
  Drawn drawn;
  const auto first = [](int x, int y, int c) { return texel(0, x, y, c); };
  const auto second = [](int x, int y, int c) { return texel(60, x, y, c); };
  const SurfaceTexture whole{drawn.texture(kWidth, kHeight, first), {}};
  // 40 x 64 texels: pixel (x, y) lies in column 30 - y and row 7 + x.
  PatchMap turned;
  turned.linear = glm::mat2(0, kWidth / 64.0f, -kHeight / 40.0f, 0);
  turned.offset = {31 / 40.0f, 7 / 64.0f};
  const SurfaceTexture part{drawn.texture(40, 64, second), turned};
  expect_picture(drawn.picture({whole, part}), [&](int x, int y, int c) { return first(x, y, c) + second(30 - y, 7 + x, c); });
  expect_picture(drawn.picture({part}), [&](int x, int y, int c) { return second(30 - y, 7 + x, c); });
}

TEST(SceneDrawer, ACutTextureShowsWhatAnUncutOneShowsThatIsRolledByTheCut) {
  Drawn drawn;
  const auto color = [](int x, int y, int c) { return texel(0, x, y, c); };
  const SurfaceTexture uncut{drawn.texture(kWidth, kHeight, color), {}};
  const auto rolled = [&](int x, int y, int c) { return color((x + kWidth / 2) % kWidth, y, c); };
  const SurfaceTexture cut{drawn.texture(kWidth, kHeight, rolled), PatchMap{{0.5f, 0}, glm::mat2(1), {-0.5f, 0}}};
  expect_picture(drawn.picture({uncut}), color);
  expect_picture(drawn.picture({cut}), color);
}

// The halves change sides in the texture, and each patch's map brings its own back.
TEST(SceneDrawer, EachPatchOfASurfaceIsLaidByItsOwnMap) {
  Drawn drawn(2, kPatchStep);
  const auto color = [](int x, int y, int c) { return texel(0, x, y, c); };
  const auto swapped = [&](int x, int y, int c) { return color((x + kWidth / 2) % kWidth, y, c); };
  TextureMap map;
  map.patch_count = 2;
  map.patches.fill(PatchMap{{}, glm::mat2(1), {-0.5f, 0}});
  map.patches[0].offset.x = 0.5f;
  const SurfaceTexture texture{drawn.texture(kWidth, kHeight, swapped), map};
  expect_picture(drawn.picture({texture}), color);
  expect_picture(drawn.picture({texture, texture}), [&](int x, int y, int c) { return 2 * color(x, y, c); });
}

TEST(SceneDrawer, ASurfaceWithoutTexturesIsBlack) {
  Drawn drawn(0);
  const std::vector<float> rgba = drawn.picture({});
  for (size_t i = 0; i < rgba.size(); ++i) ASSERT_EQ(rgba[i], i % 4 == 3 ? 1.0f : 0.0f) << i;
}

TEST(SceneDrawer, MoreTexturesThanItWasMadeForAreRefused) {
  Drawn drawn(1);
  const SurfaceTexture texture{drawn.texture(kWidth, kHeight, [](int, int, int) { return 1.0f; }), {}};
  const SurfaceTexture two[] = {texture, texture};
  ASSERT_TRUE(drawn.drawer.begin().ok());
  EXPECT_EQ(drawn.drawer.draw(drawn.halves(), glm::mat4(1), false, two).code(), StatusCode::kMalformed);
  EXPECT_TRUE(drawn.drawer.end().ok());
  EXPECT_FALSE(SceneDrawer::create(*drawn.gpu, {.width = 8, .height = 8, .max_textures = kMaxSurfaceTextures + 1}).ok());
}

}  // namespace
}  // namespace vitrine
