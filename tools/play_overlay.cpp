// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "tools/play_overlay.h"

#include <algorithm>
#include <array>

// Its glyphs are axis-parallel rectangles, which are filled here into a texture.
#include <stb/stb_easy_font.h>

namespace vitrine {
namespace {

constexpr char kVertex[] = R"(
layout(location = 0) in vec2 corner;
uniform vec4 params[1];  // size of the box in clip space
out vec2 surface;
void main() {
  surface = corner;
  gl_Position = vec4(-1.0 + corner.x * params[0].x, 1.0 - (1.0 - corner.y) * params[0].y, 0.0, 1.0);
})";
constexpr char kFragment[] = R"(
uniform sampler2D text;
in vec2 surface;
layout(location = 0) out vec4 color;
void main() { color = texture(text, surface); })";

struct FontVertex {
  float x, y, z;
  uint8_t color[4];
};

}  // namespace

Result<std::unique_ptr<Overlay>> Overlay::create(hal::Gpu& gpu) {
  std::unique_ptr<Overlay> overlay(new Overlay(gpu));
  if (Status status = overlay->create_objects(); !status.ok()) return status;
  return Result<std::unique_ptr<Overlay>>(std::move(overlay));
}

Status Overlay::create_objects() {
  static constexpr const char* kSamplers[] = {"text"};
  static constexpr hal::VertexAttribute kCorner[] = {{0, 2, 0}};
  static constexpr std::array<float, 8> kCorners{0, 0, 1, 0, 1, 1, 0, 1};
  static constexpr std::array<uint32_t, 6> kIndices{0, 1, 2, 0, 2, 3};
  const auto texture = gpu_->create_texture({kWidth, kHeight, 1, hal::TextureFormat::kRgba8, hal::TextureFilter::kNearest});
  if (!texture.ok()) return texture.status();
  const auto program =
      gpu_->create_program({.vertex = kVertex, .fragment = kFragment, .samplers = kSamplers, .uniform_count = 1});
  if (!program.ok()) return program.status();
  const auto mesh = gpu_->create_mesh({std::as_bytes(std::span(kCorners)), 8, kCorner, kIndices});
  if (!mesh.ok()) return mesh.status();
  texture_ = texture.value();
  program_ = program.value();
  mesh_ = mesh.value();
  return {};
}

// In texels, y downwards from the top.
void Overlay::fill(float left, float top, float right, float bottom) {
  for (int y = std::max(0, static_cast<int>(top)); y < std::min(kHeight, static_cast<int>(bottom)); ++y)
    for (int x = std::max(0, static_cast<int>(left)); x < std::min(kWidth, static_cast<int>(right)); ++x)
      std::fill_n(texels_.begin() + 4 * ((kHeight - 1 - y) * kWidth + x), 3, uint8_t{255});
}

Status Overlay::draw(const char* text) {
  for (size_t i = 0; i < texels_.size(); i += 4) texels_[i] = texels_[i + 1] = texels_[i + 2] = 24, texels_[i + 3] = 255;
  static std::array<FontVertex, 16384> vertices;
  const int quads = stb_easy_font_print(4, 5, const_cast<char*>(text), nullptr, vertices.data(), sizeof vertices);
  for (int q = 0; q < quads; ++q) {
    const FontVertex& a = vertices[static_cast<size_t>(4 * q)];
    const FontVertex& c = vertices[static_cast<size_t>(4 * q + 2)];
    fill(a.x, a.y, c.x, c.y);
  }
  if (Status status = gpu_->update_texture(texture_, 0, 0, 0, kWidth, kHeight, std::as_bytes(std::span(texels_))); !status.ok())
    return status;
  const std::array<float, 4> size{2.0f * kWidth / static_cast<float>(gpu_->width()),
                                  2.0f * kHeight / static_cast<float>(gpu_->height()), 0, 0};
  if (Status status = gpu_->begin_pass({.target = {}, .clear = false}); !status.ok()) return status;
  const Status drawn = gpu_->draw(
      {.program = program_, .mesh = mesh_, .index_count = 6, .textures = {&texture_, 1}, .uniforms = size, .depth_test = false});
  const Status ended = gpu_->end_pass();
  return drawn.ok() ? ended : drawn;
}

}  // namespace vitrine
