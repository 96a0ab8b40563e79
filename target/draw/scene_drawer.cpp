// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/draw/scene_drawer.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

#include "target/draw/resolve.h"
#include "target/draw/surface_program.h"

namespace vitrine {
namespace {

// params[0]: exposure, supersampling, first tap, tap count; params[1..2]: weights.
constexpr int kResolveUniforms = 3;
constexpr char kResolveVertex[] = R"(
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); })";
constexpr char kResolveFragment[] = R"(
uniform sampler2D picture;
uniform vec4 params[3];
layout(location = 0) out vec4 color;
float weight(int k) { return params[1 + k / 4][k % 4]; }
vec3 srgb(vec3 c) { return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, vec3(lessThanEqual(c, vec3(0.0031308)))); }
void main() {
  ivec2 size = textureSize(picture, 0);
  ivec2 corner = ivec2(gl_FragCoord.xy) * int(params[0].y) + int(params[0].z);
  int count = int(params[0].w);
  vec3 sum = vec3(0.0);
  float weights = 0.0;
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < count; ++i) {
      ivec2 at = corner + ivec2(i, j);
      if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) continue;
      float w = weight(i) * weight(j);
      sum += w * texelFetch(picture, at, 0).rgb;
      weights += w;
    }
  vec3 linear = clamp(params[0].x * sum / max(weights, 1e-6), 0.0, 1.0);
  color = vec4(srgb(linear), 1.0);
})";

Status check(const DrawerDesc& desc) {
  if (desc.width < 1 || desc.height < 1) return {StatusCode::kMalformed, "the picture has no pixels"};
  if (desc.supersampling < 1 || desc.supersampling > kMaxSupersampling)
    return {StatusCode::kMalformed, "supersampling is not in 1..4"};
  if (desc.max_textures < 0 || desc.max_textures > kMaxSurfaceTextures)
    return {StatusCode::kMalformed, "an object's textures are not 0..8"};
  return {};
}

Result<hal::Program> create_resolve_program(hal::Gpu& gpu) {
  static constexpr const char* kSamplers[] = {"picture"};
  return gpu.create_program(
      {.vertex = kResolveVertex, .fragment = kResolveFragment, .samplers = kSamplers, .uniform_count = kResolveUniforms});
}

}  // namespace

Result<SceneDrawer> SceneDrawer::create(hal::Gpu& gpu, const DrawerDesc& desc) {
  if (Status status = check(desc); !status.ok()) return status;
  SceneDrawer drawer;
  drawer.gpu_ = &gpu;
  drawer.desc_ = desc;
  const auto target = gpu.create_target({drawer.supersampled_width(), drawer.supersampled_height(), desc.target_format, true});
  if (!target.ok()) return target.status();
  drawer.supersampled_ = target.value();
  if (Status status = drawer.create_programs(); !status.ok()) {
    drawer.destroy();  // what was made of it: id 0 is none
    return status;
  }
  return drawer;
}

Status SceneDrawer::create_programs() {
  const auto resolve_program = create_resolve_program(*gpu_);
  if (!resolve_program.ok()) return resolve_program.status();
  resolve_program_ = resolve_program.value();
  for (int count = 0; count <= desc_.max_textures; ++count) {
    const auto program = create_surface_program(*gpu_, desc_.filter, count);
    if (!program.ok()) return program.status();
    draw_programs_[static_cast<size_t>(count)] = program.value();
  }
  return {};
}

Result<hal::Program> SceneDrawer::create_program(const char* fragment) {
  return create_surface_probe(*gpu_, desc_.filter, fragment);
}

void SceneDrawer::destroy() {
  if (!gpu_) return;
  for (const hal::Program program : draw_programs_) gpu_->destroy(program);
  gpu_->destroy(resolve_program_);
  gpu_->destroy(supersampled_);
  gpu_ = nullptr;
}

Result<DrawMesh> SceneDrawer::create_mesh(std::span<const MeshVertex> vertices, std::span<const uint32_t> indices,
                                          uint32_t culled_index_count) {
  if (culled_index_count > indices.size() || culled_index_count % 3)
    return Status{StatusCode::kMalformed, "the culled indices are not whole triangles of the mesh"};
  static constexpr hal::VertexAttribute kAttributes[] = {{0, 3, offsetof(MeshVertex, x)}, {1, 2, offsetof(MeshVertex, u)}};
  const auto mesh = gpu_->create_mesh({std::as_bytes(vertices), sizeof(MeshVertex), kAttributes, indices});
  if (!mesh.ok()) return mesh.status();
  return DrawMesh{mesh.value(), static_cast<uint32_t>(indices.size()), culled_index_count};
}

Result<hal::Texture> SceneDrawer::create_texture(int width, int height, hal::TextureFormat format) {
  const int levels = std::bit_width(static_cast<unsigned>(width > height ? width : height));
  return gpu_->create_texture({width, height, levels, format, hal::TextureFilter::kTrilinear});
}

Status SceneDrawer::begin() { return gpu_->begin_pass({.target = supersampled_}); }

Status SceneDrawer::draw(const DrawMesh& mesh, const glm::mat4& clip_from_object, bool mirrored,
                         std::span<const SurfaceTexture> textures) {
  if (textures.size() > static_cast<size_t>(desc_.max_textures))
    return {StatusCode::kMalformed, "an object has more textures than the drawer was made for"};
  const SurfaceUniforms uniforms(clip_from_object, glm::vec4(0), textures);
  std::array<hal::Texture, kMaxSurfaceTextures> handles;
  for (size_t i = 0; i < textures.size(); ++i) handles[i] = textures[i].texture;
  return draw_parts({.program = draw_programs_[textures.size()],
                     .mesh = mesh.mesh,
                     .textures = std::span(handles).first(textures.size()),
                     .uniforms = uniforms.values()},
                    mesh, mirrored);
}

Status SceneDrawer::draw_with(hal::Program program, const glm::vec4& parameter, const DrawMesh& mesh,
                              const glm::mat4& clip_from_object, bool mirrored, const SurfaceTexture& texture) {
  const SurfaceUniforms uniforms(clip_from_object, parameter, {&texture, 1});
  return draw_parts({.program = program, .mesh = mesh.mesh, .textures = {&texture.texture, 1}, .uniforms = uniforms.values()},
                    mesh, mirrored);
}

// Single-sided triangles, then the others.
Status SceneDrawer::draw_parts(hal::Draw draw, const DrawMesh& mesh, bool mirrored) {
  draw.index_count = mesh.culled_index_count;
  draw.cull = mirrored ? hal::Cull::kFront : hal::Cull::kBack;
  if (Status status = gpu_->draw(draw); !status.ok()) return status;
  draw.first_index = mesh.culled_index_count;
  draw.index_count = mesh.index_count - mesh.culled_index_count;
  draw.cull = hal::Cull::kNone;
  return gpu_->draw(draw);
}

Status SceneDrawer::end() { return gpu_->end_pass(); }

Status SceneDrawer::resolve(hal::Target output, float exposure) {
  const ResolveTaps taps = resolve_taps(desc_.supersampling);
  std::array<float, 4 * kResolveUniforms> uniforms{exposure, static_cast<float>(desc_.supersampling),
                                                   static_cast<float>(taps.first), static_cast<float>(taps.count)};
  std::copy(taps.weight.begin(), taps.weight.end(), uniforms.begin() + 4);
  const hal::Texture picture = gpu_->color_of(supersampled_);
  if (Status status = gpu_->begin_pass({.target = output, .clear = false}); !status.ok()) return status;
  const Status drawn =
      gpu_->draw({.program = resolve_program_, .textures = {&picture, 1}, .uniforms = uniforms, .depth_test = false});
  const Status ended = gpu_->end_pass();
  return drawn.ok() ? ended : drawn;
}

}  // namespace vitrine
