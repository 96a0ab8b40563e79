// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What every device refuses, and what the null device counts. The same cases run on the null device and on OSMesa.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "hal/backends.h"
#include "hal/null/null_gpu.h"

namespace vitrine::hal {
namespace {

constexpr VertexAttribute kPosition[] = {{0, 3, 0}};
constexpr char kVertex[] = "layout(location = 0) in vec3 p; void main() { gl_Position = vec4(p, 1.0); }";
constexpr char kFragment[] =
    "uniform sampler2D t; uniform vec4 params[2]; layout(location = 0) out vec4 c; void main() { c = params[1] * texelFetch(t, "
    "ivec2(0), 0); }";
constexpr const char* kTextureName[] = {"t"};

class EveryDevice : public ::testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    gpu = GetParam() ? create_null_gpu(8, 8) : std::move(create_osmesa_gpu(8, 8).value());
    texture = gpu->create_texture({4, 2, 2, TextureFormat::kRgba8, TextureFilter::kTrilinear}).value();
    mesh = gpu->create_mesh(good_mesh()).value();
    program =
        gpu->create_program({.vertex = kVertex, .fragment = kFragment, .samplers = kTextureName, .uniform_count = 2}).value();
    target = gpu->create_target({4, 4, TextureFormat::kRgba8, true}).value();
  }
  MeshDesc good_mesh() const { return {std::as_bytes(std::span(corners)), 12, kPosition, order}; }
  Draw good_draw() const {
    return {.program = program, .mesh = mesh, .index_count = 3, .textures = {&texture, 1}, .uniforms = uniforms};
  }
  Status drawn(const Draw& draw) {
    EXPECT_TRUE(gpu->begin_pass({.target = target}).ok());
    const Status status = gpu->draw(draw);
    EXPECT_TRUE(gpu->end_pass().ok());
    return status;
  }
  Status updated(int level, int x, int y, int w, int h, size_t bytes) {
    return gpu->update_texture(texture, level, x, y, w, h, std::vector<std::byte>(bytes));
  }
  std::vector<float> corners{-1, -1, 0, 3, -1, 0, -1, 3, 0};
  std::vector<uint32_t> order{0, 1, 2};
  std::array<float, 8> uniforms{};
  std::unique_ptr<Gpu> gpu;
  Texture texture;
  Mesh mesh;
  Program program;
  Target target;
};
INSTANTIATE_TEST_SUITE_P(, EveryDevice, ::testing::Bool(), [](const auto& device) { return device.param ? "null" : "osmesa"; });

TEST_P(EveryDevice, RefusesTexturesThatMakeNoSense) {
  const auto refused = [&](TextureDesc desc) { return !gpu->create_texture(desc).ok(); };
  EXPECT_TRUE(refused({0, 4, 1}) && refused({4, -1, 1}) && refused({4, 4, 0}) && refused({4, 4, 4}));
  EXPECT_TRUE(refused({std::numeric_limits<int>::max(), 1, 1}));
  EXPECT_TRUE(refused({4, 4, 1, static_cast<TextureFormat>(9)}));
  EXPECT_TRUE(refused({4, 4, 1, TextureFormat::kRgba8, static_cast<TextureFilter>(9)}));
  EXPECT_TRUE(refused({.width = 4, .height = 4, .wrap_u = static_cast<TextureWrap>(9)}));
  EXPECT_TRUE(refused({.width = 4, .height = 4, .wrap_v = static_cast<TextureWrap>(9)}));
  EXPECT_FALSE(refused({4, 4, 3}));
}

TEST_P(EveryDevice, RefusesUpdatesBeyondTheLevelOrOfWrongSize) {
  EXPECT_TRUE(updated(0, 0, 0, 4, 2, 32).ok());
  EXPECT_TRUE(updated(1, 0, 0, 2, 1, 8).ok());
  EXPECT_FALSE(updated(2, 0, 0, 1, 1, 4).ok());
  EXPECT_FALSE(updated(-1, 0, 0, 1, 1, 4).ok());
  EXPECT_FALSE(updated(0, 1, 0, 4, 2, 32).ok());
  EXPECT_FALSE(updated(0, -1, 0, 1, 1, 4).ok());
  EXPECT_FALSE(updated(0, 0, 0, 4, 2, 31).ok());
  EXPECT_FALSE(updated(0, 0, 0, 0, 0, 0).ok());
  EXPECT_FALSE(updated(0, std::numeric_limits<int>::max(), 0, std::numeric_limits<int>::max(), 1, 4).ok());
  EXPECT_FALSE(gpu->update_texture(gpu->color_of(target), 0, 0, 0, 4, 4, std::vector<std::byte>(64)).ok());
}

TEST_P(EveryDevice, RefusesMeshesThatReadBeyondTheirVertices) {
  const auto refused = [&](auto&& change) {
    MeshDesc desc = good_mesh();
    change(desc);
    return !gpu->create_mesh(desc).ok();
  };
  const std::vector<uint32_t> beyond{0, 1, 3}, partial{0, 1};
  const VertexAttribute wide[] = {{0, 4, 0}}, late[] = {{0, 3, 4}}, odd[] = {{0, 1, 2}}, twice[] = {{0, 1, 0}, {0, 1, 4}},
                        high[] = {{16, 1, 0}};
  EXPECT_FALSE(refused([](MeshDesc&) {}));
  EXPECT_TRUE(refused([&](MeshDesc& d) { d.indices = beyond; }));
  EXPECT_TRUE(refused([&](MeshDesc& d) { d.indices = partial; }));
  EXPECT_TRUE(refused([&](MeshDesc& d) { d.indices = {}; }));
  EXPECT_TRUE(refused([&](MeshDesc& d) { d.attributes = wide; }));
  EXPECT_TRUE(refused([&](MeshDesc& d) { d.attributes = late; }));
  EXPECT_TRUE(refused([&](MeshDesc& d) { d.attributes = odd; }));
  EXPECT_TRUE(refused([&](MeshDesc& d) { d.attributes = twice; }));
  EXPECT_TRUE(refused([&](MeshDesc& d) { d.attributes = high; }));
  EXPECT_TRUE(refused([&](MeshDesc& d) { d.attributes = {}; }));
  EXPECT_TRUE(refused([&](MeshDesc& d) { d.stride = 0; }));
  EXPECT_TRUE(refused([&](MeshDesc& d) { d.stride = 16; }));
  EXPECT_TRUE(refused([&](MeshDesc& d) { d.vertices = d.vertices.first(10); }));
}

TEST_P(EveryDevice, RefusesIncompletePrograms) {
  const char* const nine[] = {"a", "b", "c", "d", "e", "f", "g", "h", "i"};
  EXPECT_FALSE(gpu->create_program({.vertex = kVertex}).ok());
  EXPECT_FALSE(gpu->create_program({.vertex = kVertex, .fragment = kFragment, .samplers = nine}).ok());
  EXPECT_FALSE(
      gpu->create_program({.vertex = kVertex, .fragment = kFragment, .samplers = kTextureName, .uniform_count = 193}).ok());
}

TEST_P(EveryDevice, RefusesDrawsThatDoNotFitTheirProgramOrMesh) {
  const auto refused = [&](auto&& change) {
    Draw draw = good_draw();
    change(draw);
    return !drawn(draw).ok();
  };
  const Texture own = gpu->color_of(target);
  EXPECT_FALSE(refused([](Draw&) {}));
  EXPECT_TRUE(refused([](Draw& d) { d.program = {}; }));
  EXPECT_TRUE(refused([](Draw& d) { d.mesh = {999}; }));
  EXPECT_TRUE(refused([](Draw& d) { d.textures = {}; }));
  EXPECT_TRUE(refused([&](Draw& d) { d.textures = {&own, 1}; }));
  EXPECT_TRUE(refused([](Draw& d) { d.uniforms = d.uniforms.first(4); }));
  EXPECT_TRUE(refused([](Draw& d) { d.first_index = 1; }));
  EXPECT_TRUE(refused([](Draw& d) { d.index_count = 2; }));
  EXPECT_TRUE(refused([](Draw& d) { d.first_index = 0xffffffffu; }));
  EXPECT_TRUE(refused([](Draw& d) { d.cull = static_cast<Cull>(7); }));
  EXPECT_TRUE(refused([](Draw& d) { d.mesh = {}; }));  // the covering triangle takes no indices
}

TEST_P(EveryDevice, RefusesCallsOutOfOrder) {
  EXPECT_FALSE(gpu->draw(good_draw()).ok());
  EXPECT_FALSE(gpu->end_pass().ok());
  EXPECT_FALSE(gpu->begin_pass({.target = {999}}).ok());
  ASSERT_TRUE(gpu->begin_pass({.target = target}).ok());
  EXPECT_FALSE(gpu->begin_pass({.target = target}).ok());
  EXPECT_FALSE(gpu->present().ok());
  std::vector<std::byte> pixels(64);
  EXPECT_FALSE(gpu->read_pixels(target, TextureFormat::kRgba8, pixels).ok());
  gpu->destroy(target);  // is being drawn to: stays
  EXPECT_TRUE(gpu->end_pass().ok());
  EXPECT_TRUE(gpu->read_pixels(target, TextureFormat::kRgba8, pixels).ok());
  EXPECT_FALSE(gpu->read_pixels(target, TextureFormat::kRgba16f, pixels).ok());
  EXPECT_FALSE(gpu->read_pixels(target, TextureFormat::kRgba8, std::span(pixels).first(60)).ok());
}

TEST_P(EveryDevice, HandlesOfDestroyedObjectsAreRefusedForEver) {
  gpu->destroy(texture);
  EXPECT_FALSE(drawn(good_draw()).ok());
  const Texture next = gpu->create_texture({4, 2, 2}).value();
  EXPECT_NE(next.id, texture.id);
  EXPECT_FALSE(updated(0, 0, 0, 4, 2, 32).ok());
  gpu->destroy(texture);  // again: no effect
  gpu->destroy(gpu->color_of(target));
  texture = next;
  EXPECT_TRUE(drawn(good_draw()).ok());
  gpu->destroy(target);
  EXPECT_EQ(gpu->color_of(target).id, 0u);
  EXPECT_FALSE(gpu->begin_pass({.target = target}).ok());
}

TEST(NullGpu, CountsWhatPlaybackAsksFor) {
  NullGpu gpu(4, 4);
  const Texture texture = gpu.create_texture({4, 2, 3, TextureFormat::kRgba16f, TextureFilter::kTrilinear}).value();
  EXPECT_EQ(gpu.counts().texture_bytes, 8u * (8 + 2 + 1));
  ASSERT_TRUE(gpu.update_texture(texture, 1, 0, 0, 2, 1, std::vector<std::byte>(16)).ok());
  EXPECT_EQ(gpu.counts().updates, 1);
  EXPECT_EQ(gpu.counts().update_bytes, 16u);
  const Program program = gpu.create_program({.vertex = "", .fragment = ""}).value();
  ASSERT_TRUE(gpu.begin_pass({}).ok());
  ASSERT_TRUE(gpu.draw({.program = program}).ok());
  ASSERT_TRUE(gpu.end_pass().ok());
  ASSERT_TRUE(gpu.present().ok());
  EXPECT_EQ(gpu.counts().passes, 1);
  EXPECT_EQ(gpu.counts().draws, 1);
  EXPECT_EQ(gpu.counts().presents, 1);
  gpu.destroy(texture);
  EXPECT_EQ(gpu.counts().texture_bytes, 0u);
  std::vector<std::byte> pixels(64, std::byte{1});
  ASSERT_TRUE(gpu.read_pixels({}, TextureFormat::kRgba8, pixels).ok());
  EXPECT_EQ(pixels[63], std::byte{0});
}

}  // namespace
}  // namespace vitrine::hal
