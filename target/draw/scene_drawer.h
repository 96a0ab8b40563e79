// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Draws textured objects into a supersampled linear picture and resolves it to the screen. The engine plays with it, and
// the host reads the rendering matrix off it (host/infer): what is inverted is what will run.
//
// A picture is drawn at `supersampling` times the output size into a float target, without antialiasing, each fragment reading
// its textures, which add, as surface_filter.h says; the resolve pass filters it with formats/pixel_filter.h, multiplies by the
// exposure, clamps and applies the sRGB curve.
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "formats/mesh.h"
#include "formats/status.h"
#include "formats/texture_map.h"
#include "hal/gpu.h"
#include "target/draw/surface_filter.h"

namespace vitrine {

struct DrawerDesc {
  int width = 0, height = 0;                                        // output pixels
  int supersampling = 2;                                            // 1..4
  hal::TextureFormat target_format = hal::TextureFormat::kRgba16f;  // kRgba32f for inference
  SurfaceFilter filter = SurfaceFilter::kTrilinear;
  int max_textures = 1;  // of one object, 0..kMaxSurfaceTextures
};

inline constexpr int kMaxSurfaceTextures = 8;  // of one object

// A texture and where it lies on the mesh.
struct SurfaceTexture {
  hal::Texture texture;
  TextureMap map;
};

struct DrawMesh {
  hal::Mesh mesh;
  uint32_t index_count = 0;
  uint32_t culled_index_count = 0;  // the first of them are drawn with back faces culled
};

class SceneDrawer {
 public:
  static Result<SceneDrawer> create(hal::Gpu& gpu, const DrawerDesc& desc);

  void destroy();  // its programs and its target; meshes and textures are their makers'

  Result<DrawMesh> create_mesh(std::span<const MeshVertex> vertices, std::span<const uint32_t> indices,
                               uint32_t culled_index_count);
  // Linear texture with a full MIP chain down to 1 x 1, trilinear, clamped.
  Result<hal::Texture> create_texture(int width, int height, hal::TextureFormat format);

  // begin; draw every object; end: the supersampled picture stands in supersampled(). resolve: filters it into `output`
  // (id 0: the screen).
  Status begin();
  // `mirrored`: world_from_object turns the surface inside out (negative determinant). The sum of at most desc().max_textures
  // textures is drawn (alpha: the first one's); black where there are none.
  Status draw(const DrawMesh& mesh, const glm::mat4& clip_from_object, bool mirrored, std::span<const SurfaceTexture> textures);
  // The same of one texture by a program of one's own, for who wants to know how the device draws: its fragment shader finds
  // `uniform sampler2D radiance`, `in vec2 surface`, surface_filter.h's function and the vector `parameter`.
  Result<hal::Program> create_program(const char* fragment);
  Status draw_with(hal::Program program, const glm::vec4& parameter, const DrawMesh& mesh, const glm::mat4& clip_from_object,
                   bool mirrored, const SurfaceTexture& texture);
  Status end();
  Status resolve(hal::Target output, float exposure);

  hal::Target supersampled() const { return supersampled_; }
  int supersampled_width() const { return desc_.width * desc_.supersampling; }
  int supersampled_height() const { return desc_.height * desc_.supersampling; }
  const DrawerDesc& desc() const { return desc_; }

 private:
  Status create_programs();
  Status draw_parts(hal::Draw draw, const DrawMesh& mesh, bool mirrored);

  hal::Gpu* gpu_ = nullptr;
  DrawerDesc desc_;
  hal::Target supersampled_;
  std::array<hal::Program, kMaxSurfaceTextures + 1> draw_programs_;  // by the number of textures
  hal::Program resolve_program_;
};

}  // namespace vitrine
