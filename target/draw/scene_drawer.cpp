// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/draw/scene_drawer.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstring>

#include "target/draw/resolve.h"
#include "target/draw/surface_filter.h"

namespace vitrine {
namespace {

constexpr int kDrawUniforms = 5;  // clip_from_object, by columns; then what a program of create_program() is given
constexpr char kDrawVertex[] = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 texture_coordinate;
uniform vec4 params[5];
out vec2 surface;
void main() {
  surface = texture_coordinate;
  gl_Position = mat4(params[0], params[1], params[2], params[3]) * vec4(position, 1.0);
})";
constexpr char kDrawFragment[] = R"(
uniform sampler2D radiance;
in vec2 surface;
layout(location = 0) out vec4 color;
void main() {
  vec2 at;
  vec4 sum = vec4(0.0);
  for (int tap = 0; tap < surface_taps; ++tap) sum += surface_tap(radiance, surface, tap, at);
  color = sum / float(surface_taps);
})";

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
  const auto draw_program = drawer.create_program(kDrawFragment);
  const auto resolve_program = create_resolve_program(gpu);
  drawer.draw_program_ = draw_program.value();
  drawer.resolve_program_ = resolve_program.value();
  if (draw_program.ok() && resolve_program.ok()) return drawer;
  drawer.destroy();  // what was made of it: id 0 is none
  return draw_program.ok() ? resolve_program.status() : draw_program.status();
}

Result<hal::Program> SceneDrawer::create_program(const char* fragment) {
  static constexpr const char* kSamplers[] = {"radiance"};
  return gpu_->create_program({.vertex = kDrawVertex,
                               .fragment = fragment,
                               .fragment_library = surface_tap_source(desc_.filter),
                               .samplers = kSamplers,
                               .uniform_count = kDrawUniforms});
}

void SceneDrawer::destroy() {
  if (!gpu_) return;
  gpu_->destroy(draw_program_);
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

Status SceneDrawer::draw(const DrawMesh& mesh, const glm::mat4& clip_from_object, bool mirrored, hal::Texture texture) {
  return draw_with(draw_program_, {}, mesh, clip_from_object, mirrored, texture);
}

Status SceneDrawer::draw_with(hal::Program program, const glm::vec4& parameter, const DrawMesh& mesh,
                              const glm::mat4& clip_from_object, bool mirrored, hal::Texture texture) {
  std::array<float, 4 * kDrawUniforms> uniforms;
  std::memcpy(uniforms.data(), &clip_from_object, sizeof clip_from_object);
  std::memcpy(uniforms.data() + 16, &parameter, sizeof parameter);
  hal::Draw draw{.program = program,
                 .mesh = mesh.mesh,
                 .index_count = mesh.culled_index_count,
                 .textures = {&texture, 1},
                 .uniforms = uniforms};
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
