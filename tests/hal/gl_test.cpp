// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What the GL device draws, against closed forms, on OSMesa.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <thread>
#include <vector>

#include "hal/backends.h"

namespace vitrine::hal {
namespace {

constexpr char kCover[] =
    "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }";
constexpr char kConstant[] = "uniform vec4 params[1]; layout(location = 0) out vec4 c; void main() { c = params[0]; }";
constexpr char kFetch[] =
    "uniform sampler2D t; uniform vec4 params[1]; layout(location = 0) out vec4 c; void main() { c = textureLod(t, params[0].xy, "
    "params[0].z); }";
constexpr char kPlace[] = "layout(location = 0) in vec3 p; void main() { gl_Position = vec4(p, 1.0); }";
constexpr const char* kSampler[] = {"t"};

class GlTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto created = create_osmesa_gpu(8, 4);
    ASSERT_TRUE(created.ok()) << created.status().detail();
    gpu = std::move(created.value());
  }
  Target float_target(int width, int height) {
    return gpu->create_target({width, height, TextureFormat::kRgba32f, true}).value();
  }
  Program program(const char* vertex, const char* fragment, bool samples) {
    ProgramDesc desc{.vertex = vertex, .fragment = fragment, .uniform_count = 1};
    if (samples) desc.samplers = kSampler;
    auto made = gpu->create_program(desc);
    EXPECT_TRUE(made.ok());
    return made.value();
  }
  std::vector<float> read(Target target, int width, int height) {
    std::vector<float> pixels(static_cast<size_t>(4 * width * height), -1.0f);
    EXPECT_TRUE(gpu->read_pixels(target, TextureFormat::kRgba32f, std::as_writable_bytes(std::span(pixels))).ok());
    return pixels;
  }
  void draw(const Draw& draw, Target target, bool clear = true) {
    ASSERT_TRUE(gpu->begin_pass({.target = target, .clear = clear}).ok());
    const Status drawn = gpu->draw(draw);
    EXPECT_TRUE(drawn.ok()) << drawn.detail();
    EXPECT_TRUE(gpu->end_pass().ok());
  }
  Mesh triangle(float z, bool counter_clockwise) {
    const std::vector<float> corners{-1, -1, z, 3, -1, z, -1, 3, z};
    const std::vector<uint32_t> order = counter_clockwise ? std::vector<uint32_t>{0, 1, 2} : std::vector<uint32_t>{0, 2, 1};
    static constexpr VertexAttribute kPosition[] = {{0, 3, 0}};
    return gpu->create_mesh({std::as_bytes(std::span(corners)), 12, kPosition, order}).value();
  }
  std::unique_ptr<Gpu> gpu;
};

// Bilinear at (u, v) of a level, by the GL specification (section 8.14): texel centres at (i + 1/2) / n, clamped at the edge.
float bilinear(const std::vector<float>& level, int w, int h, float u, float v) {
  const float x = u * static_cast<float>(w) - 0.5f, y = v * static_cast<float>(h) - 0.5f;
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  const float a = x - static_cast<float>(x0), b = y - static_cast<float>(y0);
  const auto at = [&](int i, int j) { return level[static_cast<size_t>(std::clamp(j, 0, h - 1) * w + std::clamp(i, 0, w - 1))]; };
  return (1 - b) * ((1 - a) * at(x0, y0) + a * at(x0 + 1, y0)) + b * ((1 - a) * at(x0, y0 + 1) + a * at(x0 + 1, y0 + 1));
}

TEST_F(GlTest, TrilinearFetchMatchesTheFormulaOfTheSpecification) {
  const int sizes[3][2] = {{5, 3}, {2, 1}, {1, 1}};
  const Texture texture = gpu->create_texture({5, 3, 3, TextureFormat::kRgba32f, TextureFilter::kTrilinear}).value();
  std::array<std::vector<float>, 3> levels;
  for (int l = 0; l < 3; ++l) {
    std::vector<float> texels;
    for (int i = 0; i < sizes[l][0] * sizes[l][1]; ++i) {
      levels[static_cast<size_t>(l)].push_back(static_cast<float>((i * 7 + l * 3) % 11));
      for (int c = 0; c < 4; ++c) texels.push_back(levels[static_cast<size_t>(l)].back());
    }
    ASSERT_TRUE(gpu->update_texture(texture, l, 0, 0, sizes[l][0], sizes[l][1], std::as_bytes(std::span(texels))).ok());
  }
  const Target target = float_target(1, 1);
  const Program fetch = program(kCover, kFetch, true);
  for (float u : {0.0f, 0.13f, 0.5f, 0.77f, 1.0f})
    for (float v : {0.05f, 0.4f, 0.93f})
      for (float lod : {0.0f, 0.25f, 0.5f, 1.0f, 1.75f, 2.0f}) {
        const std::array<float, 4> where{u, v, lod, 0};
        draw({.program = fetch, .textures = {&texture, 1}, .uniforms = where}, target);
        const int low = std::min(static_cast<int>(lod), 1);
        const auto at = [&](int l) { return bilinear(levels[static_cast<size_t>(l)], sizes[l][0], sizes[l][1], u, v); };
        const float t = lod - static_cast<float>(low);
        EXPECT_NEAR(read(target, 1, 1)[0], (1 - t) * at(low) + t * at(low + 1), 2e-2) << u << ' ' << v << ' ' << lod;
      }
}

TEST_F(GlTest, ATextureRepeatsAlongTheDimensionsThatItWraps) {
  const Target target = float_target(1, 1);
  const Program fetch = program(kCover, kFetch, true);
  const std::array<uint8_t, 16> corners{10, 0, 0, 0, 20, 0, 0, 0,
                                        30, 0, 0, 0, 40, 0, 0, 0};  // red at (0, 0), (1, 0), (0, 1), (1, 1)
  const auto red_beyond_the_corner = [&](TextureWrap u, TextureWrap v) {
    const Texture texture = gpu->create_texture({2, 2, 1, TextureFormat::kRgba8, TextureFilter::kBilinear, u, v}).value();
    EXPECT_TRUE(gpu->update_texture(texture, 0, 0, 0, 2, 2, std::as_bytes(std::span(corners))).ok());
    const std::array<float, 4> where{1.25f, 1.25f, 0, 0};
    draw({.program = fetch, .textures = {&texture, 1}, .uniforms = where}, target);
    return std::lround(255 * read(target, 1, 1)[0]);
  };
  EXPECT_EQ(red_beyond_the_corner(TextureWrap::kClampToEdge, TextureWrap::kClampToEdge), 40);
  EXPECT_EQ(red_beyond_the_corner(TextureWrap::kRepeat, TextureWrap::kClampToEdge), 30);
  EXPECT_EQ(red_beyond_the_corner(TextureWrap::kClampToEdge, TextureWrap::kRepeat), 20);
  EXPECT_EQ(red_beyond_the_corner(TextureWrap::kRepeat, TextureWrap::kRepeat), 10);
}

TEST_F(GlTest, UpdateChangesItsRectangleOnly) {
  const Texture texture = gpu->create_texture({4, 4, 1, TextureFormat::kRgba8, TextureFilter::kNearest}).value();
  std::vector<uint8_t> all(64, 10), part(4 * 2, 200);
  ASSERT_TRUE(gpu->update_texture(texture, 0, 0, 0, 4, 4, std::as_bytes(std::span(all))).ok());
  ASSERT_TRUE(gpu->update_texture(texture, 0, 1, 3, 2, 1, std::as_bytes(std::span(part))).ok());
  const char* copy =
      "uniform sampler2D t; uniform vec4 params[1]; layout(location = 0) out vec4 c; void main() { c = texelFetch(t, "
      "ivec2(gl_FragCoord.xy), 0); }";
  const Target target = float_target(4, 4);
  const std::array<float, 4> none{};
  draw({.program = program(kCover, copy, true), .textures = {&texture, 1}, .uniforms = none}, target);
  const auto pixels = read(target, 4, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x)
      EXPECT_FLOAT_EQ(pixels[static_cast<size_t>(4 * (4 * y + x))], (y == 3 && (x == 1 || x == 2) ? 200 : 10) / 255.0f)
          << x << ' ' << y;
}

TEST_F(GlTest, FloatTargetsKeepLightBeyondWhiteAndBelowBlack) {
  const Target target = float_target(3, 2);
  const std::array<float, 4> light{1e4f, -2.5f, 1.0f / 3.0f, 0};
  draw({.program = program(kCover, kConstant, false), .uniforms = light}, target);
  const auto pixels = read(target, 3, 2);
  for (size_t i = 0; i < pixels.size(); ++i) EXPECT_EQ(pixels[i], light[i % 4]);
  std::vector<uint8_t> bytes(24);
  ASSERT_TRUE(gpu->read_pixels(target, TextureFormat::kRgba8, std::as_writable_bytes(std::span(bytes))).ok());
  EXPECT_EQ(bytes[0], 255);
  EXPECT_EQ(bytes[1], 0);
  EXPECT_EQ(bytes[2], 85);
}

TEST_F(GlTest, RowsComeBottomFirst) {
  const char* row =
      "uniform vec4 params[1]; layout(location = 0) out vec4 c; void main() { c = vec4(gl_FragCoord.y, gl_FragCoord.x, 0.0, "
      "1.0); }";
  const Target target = float_target(2, 3);
  const std::array<float, 4> none{};
  draw({.program = program(kCover, row, false), .uniforms = none}, target);
  const auto pixels = read(target, 2, 3);
  EXPECT_EQ(pixels[0], 0.5f);
  EXPECT_EQ(pixels[4 * 5], 2.5f);
  EXPECT_EQ(pixels[4 * 5 + 1], 1.5f);
}

TEST_F(GlTest, BackFacesGoWhenCulledAndFrontFacesStay) {
  const Program flat = program(kPlace, kConstant, false);
  const std::array<float, 4> white{1, 1, 1, 1};
  const Target target = float_target(1, 1);
  const auto shown = [&](bool counter_clockwise, Cull cull) {
    draw({.program = flat, .mesh = triangle(0, counter_clockwise), .index_count = 3, .uniforms = white, .cull = cull}, target);
    return read(target, 1, 1)[0] > 0;
  };
  EXPECT_TRUE(shown(true, Cull::kNone) && shown(false, Cull::kNone));
  EXPECT_TRUE(shown(true, Cull::kBack) && !shown(false, Cull::kBack));
  EXPECT_TRUE(!shown(true, Cull::kFront) && shown(false, Cull::kFront));
}

TEST_F(GlTest, NearerSurfacesHideFartherOnesWhateverTheOrder) {
  const Program flat = program(kPlace, kConstant, false);
  const std::array<float, 4> red{1, 0, 0, 1}, blue{0, 0, 1, 1};
  const Target target = float_target(1, 1);
  const Mesh near = triangle(-0.5f, true), far = triangle(0.5f, true);
  draw({.program = flat, .mesh = near, .index_count = 3, .uniforms = red}, target);
  draw({.program = flat, .mesh = far, .index_count = 3, .uniforms = blue}, target, false);
  EXPECT_EQ(read(target, 1, 1)[0], 1);
  draw({.program = flat, .mesh = far, .index_count = 3, .uniforms = blue}, target);
  draw({.program = flat, .mesh = near, .index_count = 3, .uniforms = red}, target, false);
  EXPECT_EQ(read(target, 1, 1)[0], 1);
  draw({.program = flat, .mesh = far, .index_count = 3, .uniforms = blue, .depth_test = false}, target, false);
  EXPECT_EQ(read(target, 1, 1)[2], 1);
}

TEST_F(GlTest, TwoDevicesOfOneThreadKeepTheirOwnPictures) {
  auto other = std::move(create_osmesa_gpu(8, 4).value());
  const auto clear = [](Gpu& device, float value) {
    ASSERT_TRUE(device.begin_pass({.target = {}, .clear_color = {value, 0, 0, 1}}).ok());
    ASSERT_TRUE(device.end_pass().ok());
  };
  clear(*gpu, 1.0f);
  clear(*other, 0.2f);
  std::vector<uint8_t> a(8 * 4 * 4), b(8 * 4 * 4);
  ASSERT_TRUE(gpu->read_pixels({}, TextureFormat::kRgba8, std::as_writable_bytes(std::span(a))).ok());
  ASSERT_TRUE(other->read_pixels({}, TextureFormat::kRgba8, std::as_writable_bytes(std::span(b))).ok());
  EXPECT_EQ(a[0], 255);
  EXPECT_EQ(b[0], 51);
  other.reset();
  clear(*gpu, 0.2f);
  ASSERT_TRUE(gpu->read_pixels({}, TextureFormat::kRgba8, std::as_writable_bytes(std::span(a))).ok());
  EXPECT_EQ(a[0], 51);
}

TEST_F(GlTest, DevicesOnTwoThreadsDoNotDisturbEachOther) {
  const auto work = [](float value, bool* right) {
    auto device = std::move(create_osmesa_gpu(4, 4).value());
    *right = true;
    std::vector<uint8_t> pixels(64);
    for (int i = 0; i < 50; ++i) {
      *right &= device->begin_pass({.target = {}, .clear_color = {value, 0, 0, 1}}).ok() && device->end_pass().ok();
      *right &= device->read_pixels({}, TextureFormat::kRgba8, std::as_writable_bytes(std::span(pixels))).ok();
      *right &= pixels[0] == static_cast<uint8_t>(value * 255 + 0.5f);
    }
  };
  bool first = false, second = false;
  std::thread a(work, 0.2f, &first), b(work, 0.6f, &second);
  a.join();
  b.join();
  EXPECT_TRUE(first && second);
}

TEST_F(GlTest, ABrokenShaderIsAnErrorAndNotACrash) {
  const auto compiled = gpu->create_program({.vertex = kCover, .fragment = "void main() { nonsense }"});
  EXPECT_EQ(compiled.status().code(), StatusCode::kDevice);
  const char* gives_two = "out vec2 shared_value; void main() { shared_value = vec2(0.0); gl_Position = vec4(0.0); }";
  const char* takes_four = "in vec4 shared_value; layout(location = 0) out vec4 c; void main() { c = shared_value; }";
  EXPECT_EQ(gpu->create_program({.vertex = gives_two, .fragment = takes_four}).status().code(), StatusCode::kDevice);
}

TEST_F(GlTest, MaliciousSizesAreRefused) {
  EXPECT_FALSE(create_osmesa_gpu(0, 4).ok());
  EXPECT_FALSE(create_osmesa_gpu(1 << 20, 1 << 20).ok());
  EXPECT_FALSE(gpu->create_texture({1 << 20, 1, 1, TextureFormat::kRgba8, TextureFilter::kNearest}).ok());
}

}  // namespace
}  // namespace vitrine::hal
