// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/engine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "formats/pixel_filter.h"
#include "hal/backends.h"
#include "hal/null/null_gpu.h"
#include "target/draw/surface_filter.h"
#include "tests/target/allocations.h"
#include "tests/target/played_image.h"

namespace vitrine {
namespace {

using test::PlayedImage;
using test::PlayedImageOptions;

struct Block {
  explicit Block(size_t bytes) : size(bytes), data(static_cast<std::byte*>(::operator new (bytes, std::align_val_t{64}))) {}
  ~Block() { ::operator delete (data, std::align_val_t{64}); }
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;
  std::span<std::byte> bytes() const { return {data, size}; }
  size_t size;
  std::byte* data;
};

// A null device that remembers what level 0 of each texture holds, and what its programs read textures by.
class RememberingGpu final : public hal::Gpu {
 public:
  RememberingGpu(int width, int height) : gpu(width, height) {}
  hal::DeviceInfo info() const override { return gpu.info(); }
  Result<hal::Texture> create_texture(const hal::TextureDesc& desc) override { return gpu.create_texture(desc); }
  Status update_texture(hal::Texture texture, int level, int x, int y, int width, int height,
                        std::span<const std::byte> texels) override {
    if (level == 0) finest[texture.id].assign(texels.begin(), texels.end());
    return gpu.update_texture(texture, level, x, y, width, height, texels);
  }
  Result<hal::Mesh> create_mesh(const hal::MeshDesc& desc) override { return gpu.create_mesh(desc); }
  Result<hal::Program> create_program(const hal::ProgramDesc& desc) override {
    libraries += desc.fragment_library;
    return gpu.create_program(desc);
  }
  Result<hal::Target> create_target(const hal::TargetDesc& desc) override { return gpu.create_target(desc); }
  hal::Texture color_of(hal::Target target) override { return gpu.color_of(target); }
  void destroy(hal::Texture texture) override { gpu.destroy(texture); }
  void destroy(hal::Mesh mesh) override { gpu.destroy(mesh); }
  void destroy(hal::Program program) override { gpu.destroy(program); }
  void destroy(hal::Target target) override { gpu.destroy(target); }
  Status begin_pass(const hal::PassDesc& desc) override { return gpu.begin_pass(desc); }
  Status draw(const hal::Draw& draw) override { return gpu.draw(draw); }
  Status end_pass() override { return gpu.end_pass(); }
  Status read_pixels(hal::Target target, hal::TextureFormat format, std::span<std::byte> pixels) override {
    return gpu.read_pixels(target, format, pixels);
  }
  Status present() override { return gpu.present(); }
  int width() const override { return gpu.width(); }
  int height() const override { return gpu.height(); }

  hal::NullGpu gpu;
  std::map<uint32_t, std::vector<std::byte>> finest;
  std::string libraries;
};

template <typename Gpu>
struct Played {
  Played(const PlayedImage& image, const EngineOptions& options)
      : view(image.view()), gpu(view.directory().width(), view.directory().height()), block(Engine::required_bytes(view)) {
    auto loaded = Engine::load(view, gpu, block.bytes(), options);
    EXPECT_TRUE(loaded.ok()) << loaded.status().detail();
    engine = std::move(loaded.value());
  }
  void frame(float view_position, float lamp) {
    const Status status = engine->frame({view_position, lamp}, {});
    EXPECT_TRUE(status.ok()) << status.detail();
  }
  const EngineStats& stats() const { return engine->stats(); }
  ImageView view;
  Gpu gpu;
  Block block;
  std::unique_ptr<Engine> engine;
};
using NullPlayed = Played<hal::NullGpu>;

// A hand within max_speed (samples per frame): random speeds that turn now and then.
class Hand {
 public:
  Hand(uint32_t seed, float speed, int view_samples, int lamp_samples)
      : random_(seed), speed_(speed), view_samples_(view_samples), lamp_samples_(lamp_samples) {}
  void move() {
    std::uniform_real_distribution<float> pace(-1, 1);
    if (random_() % 16 == 0) {
      view_pace_ = random_() % 3 ? (pace(random_) < 0 ? -1.0f : 1.0f) : pace(random_);
      lamp_pace_ = random_() % 3 ? (pace(random_) < 0 ? -1.0f : 1.0f) : pace(random_);
    }
    view = std::clamp(view + view_pace_ * speed_ / static_cast<float>(view_samples_ - 1), 0.0f, 1.0f);
    lamp += lamp_pace_ * speed_ / static_cast<float>(lamp_samples_);
    lamp -= std::floor(lamp);
  }
  float view = 0.3f, lamp = 0.6f;

 private:
  std::mt19937 random_;
  float speed_, view_pace_ = 1, lamp_pace_ = -1;
  int view_samples_, lamp_samples_;
};

std::vector<uint16_t> expected_halves(const PlayedImage& image, size_t field, const Position& position) {
  std::vector<uint16_t> halves;
  const std::vector<float> radiance = image.texture(image.fields()[field], position);
  for (size_t i = 0; i < radiance.size(); ++i) {
    halves.push_back(half_from_float(radiance[i]));
    if (i % 3 == 2) halves.push_back(half_from_float(1));
  }
  return halves;
}

float srgb(float linear) { return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f; }

// The picture that formats/pixel_filter.h makes of a supersampled one, 8 bits.
std::vector<int> resolved(const std::vector<float>& rgb, int width, int height, int s, float exposure) {
  std::vector<int> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (size_t c = 0; c < 3; ++c) {
        double sum = 0, weights = 0;
        for (int j = 0; j < s * height; ++j)
          for (int i = 0; i < s * width; ++i) {
            const float dx = (static_cast<float>(i) + 0.5f) / static_cast<float>(s) - (static_cast<float>(x) + 0.5f);
            const float dy = (static_cast<float>(j) + 0.5f) / static_cast<float>(s) - (static_cast<float>(y) + 0.5f);
            if (std::fabs(dx) >= 1 || std::fabs(dy) >= 1) continue;
            const double w = static_cast<double>(pixel_filter(dx)) * static_cast<double>(pixel_filter(dy));
            sum += w * static_cast<double>(rgb[3 * static_cast<size_t>(j * s * width + i) + c]);
            weights += w;
          }
        pixels.push_back(
            static_cast<int>(255 * srgb(std::clamp(exposure * static_cast<float>(sum / weights), 0.0f, 1.0f)) + 0.5f));
      }
  return pixels;
}

class EngineStill : public ::testing::TestWithParam<std::tuple<bool, int>> {};
INSTANTIATE_TEST_SUITE_P(, EngineStill, ::testing::Combine(::testing::Bool(), ::testing::Values(1, 2, 3, 4)));

// At positions in blocks of all three maps.
TEST_P(EngineStill, IsTheSumOfTheFieldsEachLaidOnByTheMapOfItsBlock) {
  const auto [interpolate, supersampling] = GetParam();
  const PlayedImage image(
      {.width = 24, .height = 16, .supersampling = supersampling, .interpolate = interpolate, .exposure = 1.5f});
  const ImageView view = image.view();
  auto gpu = std::move(hal::create_osmesa_gpu(24, 16).value());
  const Block block(Engine::required_bytes(view));
  auto engine = std::move(Engine::load(view, *gpu, block.bytes(), {.unlimited = true}).value());
  for (const Position& position : {Position{0, 0}, Position{0.37f, 0.81f}, Position{0.6f, 0.875f}, Position{1, 0.99f}}) {
    ASSERT_TRUE(engine->frame(position, {}).ok());
    std::vector<uint8_t> pixels(4 * 24 * 16);
    ASSERT_TRUE(gpu->read_pixels({}, hal::TextureFormat::kRgba8, std::as_writable_bytes(std::span(pixels))).ok());
    const std::vector<int> expected = resolved(image.picture(position), 24, 16, supersampling, 1.5f);
    for (size_t i = 0; i < expected.size(); ++i) ASSERT_NEAR(pixels[i / 3 * 4 + i % 3], expected[i], 1) << i;
  }
  EXPECT_EQ(engine->stats().late_nodes, 0);
  EXPECT_EQ(engine->stats().damaged_nodes, 0);
}

class EngineTextures : public ::testing::TestWithParam<std::tuple<bool, NodeCoder>> {};
INSTANTIATE_TEST_SUITE_P(, EngineTextures,
                         ::testing::Combine(::testing::Bool(), ::testing::Values(NodeCoder::kDct, NodeCoder::kSpiht)));

TEST_P(EngineTextures, TexturesAreExactToTheBitAllAlongAPathWithTheSmallestCache) {
  const auto [interpolate, coder] = GetParam();
  const PlayedImage image({.width = 20, .height = 12, .interpolate = interpolate, .cache_bytes = 0, .coder = coder});
  Played<RememberingGpu> played(image, {.unlimited = true});
  Hand hand(7, 0.8f, 16, 8);
  for (int f = 0; f < 150; ++f) {
    hand.move();
    played.frame(hand.view, hand.lamp);
    ASSERT_EQ(played.gpu.finest.size(), 3u);
    size_t field = 0;
    for (const auto& [id, texels] : played.gpu.finest) {
      const auto expected = expected_halves(image, field++, {hand.view, hand.lamp});
      ASSERT_EQ(texels.size(), 2 * expected.size());
      ASSERT_EQ(std::memcmp(texels.data(), expected.data(), texels.size()), 0) << "frame " << f << " field " << field - 1;
    }
  }
}

class EngineMotion : public ::testing::TestWithParam<std::tuple<bool, NodeCoder>> {};
INSTANTIATE_TEST_SUITE_P(, EngineMotion,
                         ::testing::Combine(::testing::Bool(), ::testing::Values(NodeCoder::kDct, NodeCoder::kSpiht)));

TEST_P(EngineMotion, WithinMaxSpeedIsNeverLateNeverOverAndAllocatesNothing) {
  const auto [interpolate, coder] = GetParam();
  const PlayedImage image({.interpolate = interpolate, .units_budget = 200000, .coder = coder});
  NullPlayed played(image, {});
  Hand hand(3, 0.25f, 16, 8);
  for (int f = 0; f < 8; ++f) played.frame(hand.view, hand.lamp);  // settle
  const int64_t settling = played.stats().settling_frames;
  const int64_t before = test::allocations();
  for (int f = 0; f < 1000; ++f) {
    hand.move();
    const Status status = played.engine->frame({hand.view, hand.lamp}, {});
    ASSERT_TRUE(status.ok());
  }
  EXPECT_EQ(test::allocations(), before);
  EXPECT_EQ(played.stats().late_nodes, 0);
  EXPECT_EQ(played.stats().overruns, 0);
  EXPECT_EQ(played.stats().settling_frames, settling);
  EXPECT_EQ(played.stats().frames, 1008);
  EXPECT_LE(played.stats().units_max, 200000u);
  EXPECT_GT(played.stats().units_sum, 0u);
}

TEST(Engine, ATooSmallBudgetMakesNodesLateButIsKept) {
  const PlayedImage image({.units_budget = 25000, .max_speed = 1.0f});
  NullPlayed played(image, {});
  Hand hand(3, 1.0f, 16, 8);
  for (int f = 0; f < 40; ++f) played.frame(hand.view, hand.lamp);
  EXPECT_EQ(played.stats().late_nodes, 0) << "standing still after a jump counts as settling";
  EXPECT_GT(played.stats().settling_frames, 0);
  for (int f = 0; f < 300; ++f) {
    hand.move();
    played.frame(hand.view, hand.lamp);
    ASSERT_LE(played.stats().units_last, 25000u);
  }
  EXPECT_GT(played.stats().late_nodes, 0);
  EXPECT_EQ(played.stats().overruns, 0);
}

TEST(Engine, ALatePictureIsMadeOfTheCoarserLevels) {
  const PlayedImage image({.width = 20, .height = 12, .units_budget = 1});  // one tile a frame
  Played<RememberingGpu> played(image, {});
  played.frame(0.5f, 0.5f);
  EXPECT_EQ(played.stats().late_nodes, 0);
  EXPECT_EQ(played.stats().settling_frames, 1);
  const auto first = played.gpu.finest;
  for (int f = 0; f < 400; ++f) played.frame(0.5f, 0.5f);
  EXPECT_LT(played.stats().settling_frames, 200);
  size_t field = 0;
  for (const auto& [id, texels] : played.gpu.finest) {
    const auto expected = expected_halves(image, field++, {0.5f, 0.5f});
    EXPECT_EQ(std::memcmp(texels.data(), expected.data(), texels.size()), 0) << "the settled picture is not the exact one";
  }
  EXPECT_NE(std::memcmp(first.begin()->second.data(), played.gpu.finest.begin()->second.data(), first.begin()->second.size()), 0);
}

TEST(Engine, AJumpSettlesWithoutLateNodes) {
  const PlayedImage image({.units_budget = 30000});
  NullPlayed played(image, {});
  for (int jump = 0; jump < 10; ++jump)
    for (int f = 0; f < 30; ++f) played.frame(jump % 2 ? 0.9f : 0.1f, 0.0f);
  EXPECT_EQ(played.stats().late_nodes, 0);
  EXPECT_GT(played.stats().settling_frames, 0);
  EXPECT_LT(played.stats().settling_frames, 10 * 20);
  EXPECT_EQ(played.stats().overruns, 0);
}

TEST(Engine, ATextureIsUploadedOnlyWhenWhatItShowsChanges) {
  const PlayedImage image({});
  NullPlayed played(image, {});
  for (int f = 0; f < 5; ++f) played.frame(0.5f, 0.5f);
  const int64_t updates = played.gpu.counts().updates;
  for (int f = 0; f < 20; ++f) played.frame(0.5f, 0.5f);
  EXPECT_EQ(played.gpu.counts().updates, updates);
  EXPECT_EQ(played.stats().upload_bytes_last, 0u);
  EXPECT_EQ(played.gpu.counts().draws, 25 * (2 + 1)) << "two objects and the resolve pass a frame";
}

uint64_t upload_bytes(const test::PlayedField& field) { return 8 * texels_with_mips(field.width, field.height); }

TEST(Engine, ATurnOfTheCameraUploadsNoTextureThatDoesNotDependOnIt) {
  const PlayedImage image({});
  const auto& fields = image.fields();  // of the lamp, of view and lamp, of nothing
  NullPlayed played(image, {.unlimited = true});
  played.frame(0.5f, 0.5f);
  EXPECT_EQ(played.stats().upload_bytes_last, upload_bytes(fields[0]) + upload_bytes(fields[1]) + upload_bytes(fields[2]));
  played.frame(0.58f, 0.5f);
  EXPECT_EQ(played.stats().upload_bytes_last, upload_bytes(fields[1]));
  played.frame(0.58f, 0.7f);
  EXPECT_EQ(played.stats().upload_bytes_last, upload_bytes(fields[0]) + upload_bytes(fields[1]));
  EXPECT_EQ(played.gpu.counts().update_bytes,
            2 * upload_bytes(fields[0]) + 3 * upload_bytes(fields[1]) + upload_bytes(fields[2]));
}

TEST(Engine, SurfacesAreReadByTheFilterForWhichTheyWereMade) {
  for (const auto filter :
       {SurfaceFilter::kBilinear, SurfaceFilter::kTrilinear, SurfaceFilter::kAnisotropic2, SurfaceFilter::kAnisotropic4}) {
    const PlayedImage image({.width = 20, .height = 12, .filter = filter});
    Played<RememberingGpu> played(image, {});
    for (const auto other :
         {SurfaceFilter::kBilinear, SurfaceFilter::kTrilinear, SurfaceFilter::kAnisotropic2, SurfaceFilter::kAnisotropic4})
      EXPECT_EQ(played.gpu.libraries.find(surface_tap_source(other)) != std::string::npos, other == filter);
  }
}

TEST(Engine, AnObjectWithoutFieldsIsBlack) {
  PlayedImage image({.width = 20, .height = 12});
  fb::ObjectT& object = *image.source().directory.objects[1];
  object.fields.clear();
  image.source().sections.pop_back();  // its field's
  object.node = 1;                     // before the camera, and so before the wall
  image.rewrite();
  const ImageView view = image.view();
  auto gpu = std::move(hal::create_osmesa_gpu(20, 12).value());
  const Block block(Engine::required_bytes(view));
  auto engine = std::move(Engine::load(view, *gpu, block.bytes(), {.unlimited = true}).value());
  ASSERT_TRUE(engine->frame({0.5f, 0.5f}, {}).ok());
  std::vector<uint8_t> pixels(4 * 20 * 12, 77);
  ASSERT_TRUE(gpu->read_pixels({}, hal::TextureFormat::kRgba8, std::as_writable_bytes(std::span(pixels))).ok());
  for (size_t i = 0; i < pixels.size(); ++i) ASSERT_EQ(pixels[i], i % 4 == 3 ? 255 : 0) << i;
}

TEST(Engine, DamagedNodesAreCountedAndTheRestIsShown) {
  PlayedImage image({.width = 20, .height = 12});
  auto& source = image.source();
  for (auto& section : source.sections)
    if (section.kind == fb::SectionKind::nodes)
      for (size_t i = 0; i < section.bytes.size(); ++i) section.bytes[i] ^= static_cast<std::byte>(i * 37);
  image.rewrite();
  NullPlayed played(image, {});
  Hand hand(5, 0.25f, 16, 8);
  for (int f = 0; f < 200; ++f) {
    hand.move();
    played.frame(hand.view, hand.lamp);
  }
  EXPECT_GT(played.stats().damaged_nodes, 0);
  EXPECT_EQ(played.stats().late_nodes, 0);
}

TEST(Engine, TheBlockMustBeLargeEnoughAndAligned) {
  const PlayedImage image({.width = 20, .height = 12});
  const ImageView view = image.view();
  hal::NullGpu gpu(20, 12);
  const size_t bytes = Engine::required_bytes(view);
  const Block block(bytes + 64);
  EXPECT_EQ(Engine::load(view, gpu, block.bytes().first(bytes - 1)).status().code(), StatusCode::kOutOfMemory);
  EXPECT_EQ(Engine::load(view, gpu, block.bytes().subspan(8, bytes)).status().code(), StatusCode::kMalformed);
  EXPECT_TRUE(Engine::load(view, gpu, block.bytes().first(bytes)).ok());
  EXPECT_EQ(gpu.counts().textures, 0) << "an engine that is gone leaves nothing on the device";
  EXPECT_EQ(gpu.counts().meshes + gpu.counts().programs + gpu.counts().targets, 0);
}

TEST(Engine, StrangePositionsAreShownAsTheNearestLegalOnes) {
  const PlayedImage image({.width = 20, .height = 12, .interpolate = true});
  NullPlayed played(image, {.unlimited = true});
  for (const float strange : {-1.0f, 2.0f, NAN, INFINITY, -INFINITY, 1e30f}) {
    played.frame(strange, 0.5f);
    played.frame(0.5f, strange);
  }
  EXPECT_EQ(played.stats().late_nodes, 0);
}

}  // namespace
}  // namespace vitrine
