// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// All ways to read a rendering matrix, against what the device draws and against each other.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_precision.hpp>
#include <random>

#include "host/base/error.h"
#include "host/infer/bounding_box_reader.h"
#include "host/infer/coordinate_reader.h"
#include "host/infer/eight_bit_reader.h"
#include "host/infer/identifier_reader.h"
#include "tests/infer/test_scene.h"

namespace vitrine::testing {
namespace {

constexpr SurfaceFilter kAllFilters[] = {SurfaceFilter::kBilinear, SurfaceFilter::kTrilinear, SurfaceFilter::kAnisotropic2,
                                         SurfaceFilter::kAnisotropic4};
constexpr float kTwoSteps = 2.0f / 255;  // of an 8-bit channel: what an 8-bit device may be off
constexpr float kFloatRounding = 1e-5f;
constexpr float kAspect = 4.0f / 3;

// A quadrangle with corners at (u, v) of its texture; `from` to `from + along + across`.
void add_quadrangle(DrawnObject& object, glm::vec3 from, glm::vec3 along, glm::vec3 across, glm::vec4 uv) {
  const auto first = static_cast<uint32_t>(object.vertices.size());
  const auto add = [&](glm::vec3 p, float u, float v) { object.vertices.push_back({p.x, p.y, p.z, u, v}); };
  add(from, uv.x, uv.y);
  add(from + along, uv.z, uv.y);
  add(from + along + across, uv.z, uv.w);
  add(from + across, uv.x, uv.w);
  for (const uint32_t corner : {0, 1, 2, 0, 2, 3}) object.indices.push_back(first + corner);
}

DrawnObject quadrangle(glm::vec3 from, glm::vec3 along, glm::vec3 across, glm::vec4 uv) {
  DrawnObject object;
  add_quadrangle(object, from, along, across, uv);
  return object;
}

// A roof whose two sides are charts far apart in its texture, the second turned by a quarter.
ShownObjects roof_of_two_charts() {
  DrawnObject roof = quadrangle({-1, -0.8f, 0.5f}, {2, 0, 0}, {0, 0.7f, -0.8f}, {0.02f, 0.03f, 0.45f, 0.97f});
  add_quadrangle(roof, {-1, -0.1f, -0.3f}, {0, 0.9f, -0.1f}, {2, 0, 0}, {0.55f, 0.03f, 0.98f, 0.97f});
  return {{roof}, {{53, 70}}, {}};
}

// Three planes through each other: each hides parts of the others.
ShownObjects planes_through_each_other() {
  const glm::vec4 whole(0, 0, 1, 1);
  return {{quadrangle({-1, -1, -0.3f}, {2, 0, 0}, {0, 2, 0}, whole),
           quadrangle({-1, -0.9f, 0.6f}, {2, 0.2f, -1.6f}, {0, 1.7f, 0}, whole),
           quadrangle({-1.2f, -0.7f, 1}, {2.4f, 0.1f, 0}, {0, 0.9f, -2}, whole)},
          {{40, 40}, {33, 57}, {64, 48}},
          {}};
}

// A device that knows bytes only.
class BytesOnlyGpu final : public hal::Gpu {
 public:
  explicit BytesOnlyGpu(hal::Gpu& gpu) : gpu_(gpu) {}
  hal::DeviceInfo info() const override {
    hal::DeviceInfo info = gpu_.info();
    info.float_targets = false;
    return info;
  }
  Result<hal::Texture> create_texture(const hal::TextureDesc& desc) override {
    if (desc.format != hal::TextureFormat::kRgba8) return kRefused;
    return gpu_.create_texture(desc);
  }
  Result<hal::Target> create_target(const hal::TargetDesc& desc) override {
    if (desc.format != hal::TextureFormat::kRgba8) return kRefused;
    return gpu_.create_target(desc);
  }
  Status read_pixels(hal::Target target, hal::TextureFormat format, std::span<std::byte> pixels) override {
    if (format != hal::TextureFormat::kRgba8) return kRefused;
    return gpu_.read_pixels(target, format, pixels);
  }
  Status update_texture(hal::Texture texture, int level, int x, int y, int width, int height,
                        std::span<const std::byte> texels) override {
    return gpu_.update_texture(texture, level, x, y, width, height, texels);
  }
  Result<hal::Mesh> create_mesh(const hal::MeshDesc& desc) override { return gpu_.create_mesh(desc); }
  Result<hal::Program> create_program(const hal::ProgramDesc& desc) override { return gpu_.create_program(desc); }
  hal::Texture color_of(hal::Target target) override { return gpu_.color_of(target); }
  void destroy(hal::Texture texture) override { gpu_.destroy(texture); }
  void destroy(hal::Mesh mesh) override { gpu_.destroy(mesh); }
  void destroy(hal::Program program) override { gpu_.destroy(program); }
  void destroy(hal::Target target) override { gpu_.destroy(target); }
  Status begin_pass(const hal::PassDesc& desc) override { return gpu_.begin_pass(desc); }
  Status draw(const hal::Draw& draw) override { return gpu_.draw(draw); }
  Status end_pass() override { return gpu_.end_pass(); }
  Status present() override { return gpu_.present(); }
  int width() const override { return gpu_.width(); }
  int height() const override { return gpu_.height(); }

 private:
  static constexpr Status kRefused{StatusCode::kUnsupported, "this device knows bytes only"};
  hal::Gpu& gpu_;
};

class MatrixReadersTest : public ::testing::Test {
 protected:
  void SetUp() override {
    gpu = make_gpu();
    ASSERT_NE(gpu, nullptr);
  }
  void prepare(ShownObjects drawn, SurfaceFilter filter, std::vector<TextureWraps> textures_wrap = {}) {
    state = looking_down(drawn, kAspect, 0.6f);
    objects = std::move(drawn.objects);
    sizes = std::move(drawn.sizes);
    wraps = std::move(textures_wrap);
    options = {.width = 80, .height = 60};
    options.filter = filter;
    floats = std::make_unique<TestRenderer>(*gpu, options, objects);
    bytes = std::make_unique<TestRenderer>(*gpu, options, objects, hal::TextureFormat::kRgba8);
  }
  StateMatrix read(MatrixReader&& reader) {
    const GeometryState* const states[] = {&state};
    return reader.read(states)[0];
  }
  StateMatrix by_eight_bits() { return read(EightBitReader(*bytes, sizes, wraps)); }
  StateMatrix by_boxes() { return read(BoundingBoxReader(*floats, sizes, wraps)); }
  StateMatrix by_identifiers() { return read(IdentifierReader(*floats, sizes)); }

  template <typename Texel>
  std::vector<glm::vec4> render(TestRenderer& renderer, const std::vector<std::vector<Texel>>& texels) {
    std::vector<hal::Texture> textures;
    for (size_t i = 0; i < objects.size(); ++i) {
      const Pyramid pyramid(sizes[i].width, sizes[i].height);
      const hal::TextureFormat format = sizeof(Texel) == 4 ? hal::TextureFormat::kRgba8 : hal::TextureFormat::kRgba32f;
      textures.push_back(create_pyramid_texture(*gpu, pyramid, format, wraps.empty() ? TextureWraps{} : wraps[i]));
      update_pyramid_texture(*gpu, textures.back(), pyramid, format, std::as_bytes(std::span(texels[i])));
    }
    std::vector<glm::vec4> pixels(static_cast<size_t>(renderer.width() * renderer.height()));
    renderer.render(state, textures, pixels);
    for (const hal::Texture texture : textures) gpu->destroy(texture);
    return pixels;
  }
  size_t place(const ObjectMatrix& rows, uint32_t sample) const {
    const int s = options.supersampling, columns = rows.window.width * s;
    const int x = rows.window.x * s + static_cast<int>(sample) % columns,
              y = rows.window.y * s + static_cast<int>(sample) / columns;
    return static_cast<size_t>((floats->height() - 1 - y) * floats->width() + x);
  }
  // The largest |A x - rendering|; `largest` is what a texel of 1 is.
  template <typename Texel>
  float rendering_difference(TestRenderer& renderer, const StateMatrix& matrix, float largest) {
    std::mt19937 random(3);
    float worst = 0;
    for (int repeat = 0; repeat < 3; ++repeat) {
      std::vector<std::vector<Texel>> texels;
      for (const TextureSize& size : sizes) {
        texels.emplace_back(Pyramid(size.width, size.height).size());
        for (Texel& texel : texels.back())
          for (int k = 0; k < 4; ++k) texel[k] = static_cast<typename Texel::value_type>(random() % 256 * (largest / 255));
      }
      const std::vector<glm::vec4> pixels = render(renderer, texels);
      for (size_t i = 0; i < matrix.size(); ++i)
        for (size_t s = 0; s < matrix[i].samples.size(); ++s) {
          glm::vec4 sum(0);
          for (uint32_t e = matrix[i].starts[s]; e < matrix[i].starts[s + 1]; ++e)
            sum += matrix[i].entries[e].weight / largest * glm::vec4(texels[i][matrix[i].entries[e].texel]);
          const glm::vec4 difference = glm::abs(sum - pixels[place(matrix[i], matrix[i].samples[s])]);
          for (int k = 0; k < 4; ++k) worst = std::max(worst, difference[k]);
        }
    }
    return worst;
  }
  float eight_bit_difference(const StateMatrix& matrix) { return rendering_difference<glm::u8vec4>(*bytes, matrix, 255); }
  float float_difference(const StateMatrix& matrix) { return rendering_difference<glm::vec4>(*floats, matrix, 1); }

  std::unique_ptr<hal::Gpu> gpu;
  std::vector<DrawnObject> objects;
  std::vector<TextureSize> sizes;
  std::vector<TextureWraps> wraps;
  InferenceOptions options;
  GeometryState state;
  std::unique_ptr<TestRenderer> floats, bytes;
};

size_t sample_count(const StateMatrix& matrix) {
  size_t count = 0;
  for (const ObjectMatrix& rows : matrix) count += rows.samples.size();
  return count;
}

float largest_row_error(const StateMatrix& matrix) {
  float worst = 0;
  for (const ObjectMatrix& rows : matrix)
    for (size_t s = 0; s < rows.samples.size(); ++s) {
      float sum = 0;
      for (uint32_t e = rows.starts[s]; e < rows.starts[s + 1]; ++e) sum += rows.entries[e].weight;
      worst = std::max(worst, std::fabs(sum - 1));
    }
  return worst;
}

// Powers of two, odd sizes, magnified (8 x 8) and minified (256 x 256).
constexpr std::pair<int, int> kSizes[] = {{64, 64}, {40, 72}, {37, 101}, {256, 256}, {8, 8}, {1, 5}};

TEST_F(MatrixReadersTest, TheEightBitMatrixTimesATextureIsItsRenderingWithinTwoSteps) {
  for (const SurfaceFilter filter : kAllFilters)
    for (const auto& [width, height] : kSizes) {
      prepare(board_and_card(width, height, 24, 16), filter);
      const StateMatrix matrix = by_eight_bits();
      EXPECT_GT(sample_count(matrix), 1000u);
      EXPECT_LE(eight_bit_difference(matrix), kTwoSteps)
          << "filter " << static_cast<int>(filter) << ", " << width << " x " << height;
      EXPECT_LE(largest_row_error(matrix), 1e-3f);
    }
}

TEST_F(MatrixReadersTest, WhatEightBitsReadIsWithinTwoStepsOfWhatFloatsRead) {
  for (const SurfaceFilter filter : kAllFilters)
    for (const auto& [width, height] : kSizes) {
      prepare(board_and_card(width, height, 24, 16), filter);
      EXPECT_LE(largest_difference(by_identifiers(), by_eight_bits()), kTwoSteps)
          << "filter " << static_cast<int>(filter) << ", " << width << " x " << height;
    }
}

TEST_F(MatrixReadersTest, BlocksWithBoundingBoxesFindTheVeryWeightsThatIdentifiersFind) {
  for (const SurfaceFilter filter : kAllFilters)
    for (const auto& [width, height] : kSizes) {
      prepare(board_and_card(width, height, 24, 16), filter);
      const StateMatrix matrix = by_boxes();
      EXPECT_LE(largest_difference(by_identifiers(), matrix), kFloatRounding)
          << "filter " << static_cast<int>(filter) << ", " << width << " x " << height;
      EXPECT_LE(float_difference(matrix), kFloatRounding);
    }
}

TEST_F(MatrixReadersTest, SeamsOfChartsAreReadByAllMethods) {
  for (const SurfaceFilter filter : kAllFilters) {
    prepare(roof_of_two_charts(), filter);
    const StateMatrix identifiers = by_identifiers(), eight_bits = by_eight_bits();
    EXPECT_LE(largest_difference(identifiers, by_boxes()), kFloatRounding);
    EXPECT_LE(largest_difference(identifiers, eight_bits), kTwoSteps);
    EXPECT_LE(eight_bit_difference(eight_bits), kTwoSteps);
  }
}

TEST_F(MatrixReadersTest, ObjectsThatHideEachOtherKeepTheirOwnSamples) {
  for (const SurfaceFilter filter : {SurfaceFilter::kTrilinear, SurfaceFilter::kAnisotropic2}) {
    prepare(planes_through_each_other(), filter);
    const StateMatrix identifiers = by_identifiers(), eight_bits = by_eight_bits();
    for (const ObjectMatrix& rows : identifiers) EXPECT_GT(rows.samples.size(), 300u);
    EXPECT_LE(largest_difference(identifiers, by_boxes()), kFloatRounding);
    EXPECT_LE(largest_difference(identifiers, read(CoordinateReader(*floats, sizes))), 2e-5f);
    EXPECT_LE(largest_difference(identifiers, eight_bits), kTwoSteps);
    EXPECT_LE(eight_bit_difference(eight_bits), kTwoSteps);
  }
}

TEST_F(MatrixReadersTest, TexturesThatRepeatAreReadAcrossTheirSeams) {
  using hal::TextureWrap;
  const glm::vec4 three_times(-0.7f, -0.2f, 2.3f, 2.8f);
  for (const TextureWraps& wrap : {TextureWraps{TextureWrap::kRepeat, TextureWrap::kRepeat}, TextureWraps{TextureWrap::kRepeat},
                                   TextureWraps{.v = TextureWrap::kRepeat}})
    for (const auto& [width, height] : {std::pair{64, 32}, std::pair{37, 50}, std::pair{4, 4}, std::pair{1, 3}}) {
      prepare({{quadrangle({-2, -1, 1}, {4, 0, 0}, {0, 0, -12}, three_times)}, {{width, height}}, {}}, SurfaceFilter::kTrilinear,
              {wrap});
      const StateMatrix eight_bits = by_eight_bits(), boxes = by_boxes();
      EXPECT_LE(eight_bit_difference(eight_bits), kTwoSteps) << width << " x " << height;
      EXPECT_LE(float_difference(boxes), kFloatRounding) << width << " x " << height;
      EXPECT_LE(largest_difference(boxes, eight_bits), kTwoSteps) << width << " x " << height;
    }
}

// 3 x 6 x 6 patterns, 3 x 8 x 8 where the texture repeats (Hakura 2001, section 3.4.3); two renderings each, and two that tell
// objects and levels.
TEST_F(MatrixReadersTest, PowersOfTwoTakeAsManyPatternsAsThePaperSays) {
  using hal::TextureWrap;
  const GeometryState* const states[] = {&state};
  const auto renderings = [&](const TextureWraps& wrap) {
    prepare({{quadrangle({-2, -1, 1}, {4, 0, 0}, {0, 0, -40}, {0, 0, 2, 8})}, {{512, 512}}, {}}, SurfaceFilter::kTrilinear,
            {wrap});
    EightBitReader reader(*bytes, sizes, wraps);
    reader.read(states);
    return reader.renderings();
  };
  EXPECT_EQ(renderings({}), 2 * 108 + 2);
  EXPECT_EQ(renderings({TextureWrap::kRepeat, TextureWrap::kClampToEdge}), 2 * 3 * 8 * 6 + 2);
  EXPECT_EQ(renderings({TextureWrap::kRepeat, TextureWrap::kRepeat}), 2 * 192 + 2);
}

TEST_F(MatrixReadersTest, PatternsOfLevelsThatNobodySeesAreLeftOut) {
  prepare({{quadrangle({-2, -1, 1}, {4, 0, 0}, {0, 2, 0}, {0, 0, 1, 1})}, {{16, 16}}, {}}, SurfaceFilter::kTrilinear);
  EightBitReader reader(*bytes, sizes);
  const GeometryState* const states[] = {&state};
  const auto matrix = reader.read(states);
  EXPECT_EQ(reader.renderings(), 2 * 36 + 2);
  EXPECT_LE(eight_bit_difference(matrix[0]), kTwoSteps);
}

TEST_F(MatrixReadersTest, SeveralViewsAreReadAtOnceAsOneByOne) {
  prepare(board_and_card(40, 72, 24, 16), SurfaceFilter::kAnisotropic2);
  const GeometryState other = looking_down(board_and_card(40, 72, 24, 16), kAspect, 0.1f);
  EightBitReader reader(*bytes, sizes);
  const GeometryState* const both[] = {&other, &state};
  const auto together = reader.read(both);
  EXPECT_EQ(largest_difference(together[1], by_eight_bits()), 0);
  state = other;
  EXPECT_EQ(largest_difference(together[0], by_eight_bits()), 0);
}

TEST_F(MatrixReadersTest, ADeviceWithoutFloatsIsReadWithoutThem) {
  prepare(board_and_card(40, 72, 24, 16), SurfaceFilter::kAnisotropic2);
  BytesOnlyGpu device(*gpu);
  EXPECT_THROW(TestRenderer(device, options, objects), InputError);
  TestRenderer renderer(device, options, objects, hal::TextureFormat::kRgba8);
  const auto reader = make_matrix_reader(choose_matrix_method(renderer, sizes, state), renderer, sizes);
  EXPECT_STREQ(reader->method(), "eight_bit");
  const GeometryState* const states[] = {&state};
  EXPECT_LE(largest_difference(by_identifiers(), reader->read(states)[0]), kTwoSteps);
}

TEST_F(MatrixReadersTest, ATextureWithMoreTexelsThanNumbersIsRefused) {
  prepare(board_and_card(8, 8, 24, 16), SurfaceFilter::kTrilinear);
  sizes[0] = {4096, 4096};
  EXPECT_THROW(EightBitReader(*bytes, sizes), InputError);
}

}  // namespace
}  // namespace vitrine::testing
