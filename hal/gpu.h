// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The graphics device, thin: textures, meshes, programs, render targets, draws. GLSL ES 3.00 shaders only, so that desktop
// GL 3.3+, GL ES 3.0 and WebGL 2 all run them. hal knows no scene.
//
// Called from one thread, the one that created the device. Objects live until destroyed or until the device goes. Creation
// may allocate; update, begin_pass, draw, end_pass, present and read_pixels allocate nothing of ours. Every description is
// validated in full before the backend sees it; a bad one yields Status and has no effect. Backends: gl over a context of
// osmesa or sdl, and null (accepts everything, draws nothing, reads back zeros, counts calls and bytes).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/status.h"

namespace vitrine::hal {

enum class TextureFormat : uint8_t { kRgba8, kRgba16f, kRgba32f };
enum class TextureFilter : uint8_t { kNearest, kBilinear, kTrilinear };  // trilinear: linear in and between MIP levels
enum class TextureWrap : uint8_t { kClampToEdge, kRepeat };              // beyond 0..1
enum class Cull : uint8_t { kNone, kBack, kFront };                      // front faces wind counter-clockwise

int bytes_per_texel(TextureFormat format);

// Handles; id 0 is none. A handle of a destroyed object is refused (ids are never used again).
struct Texture {
  uint32_t id = 0;
};
struct Mesh {
  uint32_t id = 0;
};
struct Program {
  uint32_t id = 0;
};
struct Target {
  uint32_t id = 0;
};  // id 0: the context's own framebuffer

struct TextureDesc {
  int width = 0, height = 0;  // texels of level 0; level l has max(1, floor(w / 2^l)) x max(1, floor(h / 2^l))
  int levels = 1;             // 1..full chain
  TextureFormat format = TextureFormat::kRgba8;
  TextureFilter filter = TextureFilter::kBilinear;
  TextureWrap wrap_u = TextureWrap::kClampToEdge, wrap_v = TextureWrap::kClampToEdge;
};

struct VertexAttribute {
  int location = 0;    // layout(location = N) in the vertex shader
  int components = 0;  // floats, 1..4
  int offset = 0;      // bytes from the start of a vertex
};

struct MeshDesc {
  std::span<const std::byte> vertices;  // copied
  int stride = 0;                       // bytes
  std::span<const VertexAttribute> attributes;
  std::span<const uint32_t> indices;  // triangles, copied; every index < vertices.size() / stride
};

struct ProgramDesc {
  // Bodies without #version and precision lines; the backend adds what its GL wants.
  const char* vertex = nullptr;
  const char* fragment = nullptr;
  const char* fragment_library = "";  // functions that `fragment` uses, put before it
  // Samplers in the fragment shader, in the order of Draw::textures (at most 8).
  std::span<const char* const> samplers;
  // Both shaders may declare `uniform vec4 params[uniform_count];` (at most 192); a draw sets all of it.
  int uniform_count = 0;
};

struct TargetDesc {
  int width = 0, height = 0;
  TextureFormat format = TextureFormat::kRgba16f;
  bool depth = true;
};

struct PassDesc {
  Target target;
  float clear_color[4] = {0, 0, 0, 0};
  bool clear = true;  // colour and depth (to 1)
};

struct Draw {
  Program program;
  Mesh mesh;  // id 0: one triangle that covers the target, made from gl_VertexID
  uint32_t first_index = 0, index_count = 0;
  std::span<const Texture> textures;
  std::span<const float> uniforms;  // uniform_count * 4
  Cull cull = Cull::kNone;
  bool depth_test = true;  // less-or-equal, writes depth
};

struct DeviceInfo {
  const char* renderer = "";   // as the driver names itself
  bool float_targets = false;  // kRgba32f can be rendered to
  int max_texture_size = 0;
};

class Gpu {
 public:
  virtual ~Gpu() = default;
  virtual DeviceInfo info() const = 0;

  virtual Result<Texture> create_texture(const TextureDesc& desc) = 0;  // contents undefined
  // Replaces a rectangle of one level. `texels`: width * height texels of the texture's own format, rows bottom (v = 0)
  // first, tightly packed.
  virtual Status update_texture(Texture texture, int level, int x, int y, int width, int height,
                                std::span<const std::byte> texels) = 0;
  virtual Result<Mesh> create_mesh(const MeshDesc& desc) = 0;
  virtual Result<Program> create_program(const ProgramDesc& desc) = 0;  // the driver's log goes to stderr where it fails
  virtual Result<Target> create_target(const TargetDesc& desc) = 0;
  virtual Texture color_of(Target target) = 0;  // nearest filter, to sample what was drawn
  virtual void destroy(Texture texture) = 0;
  virtual void destroy(Mesh mesh) = 0;
  virtual void destroy(Program program) = 0;
  virtual void destroy(Target target) = 0;

  virtual Status begin_pass(const PassDesc& desc) = 0;  // viewport is the whole target
  virtual Status draw(const Draw& draw) = 0;
  virtual Status end_pass() = 0;

  // Rows bottom first, in `format` (kRgba8 or kRgba32f, whatever the target's own is).
  virtual Status read_pixels(Target target, TextureFormat format, std::span<std::byte> pixels) = 0;
  virtual Status present() = 0;   // shows the context's own framebuffer, waits as its swap interval says
  virtual int width() const = 0;  // of the context's own framebuffer, now
  virtual int height() const = 0;
};

}  // namespace vitrine::hal
