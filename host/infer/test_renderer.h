// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Draws all objects of one geometry state with the target's own drawing code, each with a texture of its own, and reads the
// supersampled picture back as floats. Everything that inference knows about the device it learns through this.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "hal/gpu.h"
#include "host/infer/inference.h"
#include "host/infer/pyramid.h"
#include "target/draw/scene_drawer.h"

namespace vitrine {

// Where everything stands: all grid samples that agree on it see the same texels and share one rendering matrix.
struct GeometryState {
  std::vector<glm::mat4> clip_from_object;  // per drawn object
  std::vector<uint8_t> mirrored;
  std::vector<TextureMap> maps;  // of the texture that each is drawn with; none: the mesh's own coordinates
};

// All levels of a texture, level by level as Pyramid orders them, uploaded. `texels`: of `format`.
hal::Texture create_pyramid_texture(hal::Gpu& gpu, SceneDrawer& drawer, const Pyramid& pyramid, hal::TextureFormat format,
                                    std::span<const std::byte> texels);

// What lies beyond the borders of a texture.
struct TextureWraps {
  hal::TextureWrap u = hal::TextureWrap::kClampToEdge, v = hal::TextureWrap::kClampToEdge;
};
// The same texture with borders of one's own, its texels undefined; and all its texels.
hal::Texture create_pyramid_texture(hal::Gpu& gpu, const Pyramid& pyramid, hal::TextureFormat format, const TextureWraps& wraps);
void update_pyramid_texture(hal::Gpu& gpu, hal::Texture texture, const Pyramid& pyramid, hal::TextureFormat format,
                            std::span<const std::byte> texels);

class TestRenderer {
 public:
  // `options`: picture size and supersampling. `format`: of the target; kRgba8 for devices that cannot render to floats. Throws
  // InputError where the device refuses.
  TestRenderer(hal::Gpu& gpu, const InferenceOptions& options, std::span<const DrawnObject> objects,
               hal::TextureFormat format = hal::TextureFormat::kRgba32f);
  ~TestRenderer();
  TestRenderer(const TestRenderer&) = delete;
  TestRenderer& operator=(const TestRenderer&) = delete;

  // textures[i] for object i; id 0: the object is not drawn. `pixels`: width() * height(), rows bottom first; 0 where
  // nothing is; multiples of 1/255 where format() is kRgba8.
  void render(const GeometryState& state, std::span<const hal::Texture> textures, std::span<glm::vec4> pixels);
  // The same with the sum of several textures an object.
  void render_surfaces(const GeometryState& state, std::span<const std::vector<SurfaceTexture>> surfaces,
                       std::span<glm::vec4> pixels);
  // What tap number `tap` of the filter reads, alone.
  void render_tap(const GeometryState& state, std::span<const hal::Texture> textures, int tap, std::span<glm::vec4> pixels);
  // Where it reads: texture coordinates, and the third and fourth channel of what it reads there.
  void render_coordinates(const GeometryState& state, std::span<const hal::Texture> textures, int tap,
                          std::span<glm::vec4> pixels);
  hal::TextureFormat format() const { return drawer_.desc().target_format; }
  int taps() const { return tap_count(drawer_.desc().filter); }
  int supersampling() const { return drawer_.desc().supersampling; }
  int width() const { return drawer_.supersampled_width(); }  // in supersamples
  int height() const { return drawer_.supersampled_height(); }
  hal::Gpu& gpu() { return *gpu_; }
  SceneDrawer& drawer() { return drawer_; }

 private:
  void read_back(std::span<glm::vec4> pixels);
  void render_with(hal::Program program, int tap, const GeometryState& state, std::span<const hal::Texture> textures,
                   std::span<glm::vec4> pixels);

  hal::Gpu* gpu_;
  SceneDrawer drawer_;
  hal::Program one_tap_, coordinates_;
  std::vector<DrawMesh> meshes_;
  std::vector<uint8_t> bytes_;  // of an 8-bit picture
};

}  // namespace vitrine
