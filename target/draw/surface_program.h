// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The programs that draw surfaces: a texture's coordinates are the mesh's by way of its map (formats/texture_map.h), and the
// textures of a surface add.
#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "hal/gpu.h"
#include "target/draw/scene_drawer.h"

namespace vitrine {

// Draws the sum of `count` textures, 0..kMaxSurfaceTextures.
Result<hal::Program> create_surface_program(hal::Gpu& gpu, SurfaceFilter filter, int count);
// Of one texture, with a fragment shader as SceneDrawer::create_program says.
Result<hal::Program> create_surface_probe(hal::Gpu& gpu, SurfaceFilter filter, const char* fragment);

// The uniforms of such a program.
class SurfaceUniforms {
 public:
  SurfaceUniforms(const glm::mat4& clip_from_object, const glm::vec4& parameter, std::span<const SurfaceTexture> textures);
  std::span<const float> values() const { return std::span(values_).first(count_); }

 private:
  size_t count_;
  std::array<float, 4 * (5 + 2 * kMaxPatches * kMaxSurfaceTextures)> values_;
};

}  // namespace vitrine
