// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/test_renderer.h"

#include <iterator>

#include "host/base/error.h"
#include "host/infer/fields.h"

namespace vitrine {
namespace {

constexpr char kOneTap[] = R"(
uniform sampler2D radiance;
in vec2 surface;
layout(location = 0) out vec4 color;
void main() {
  vec2 at;
  color = surface_tap(radiance, surface, int(parameter.x), at);
})";
constexpr char kCoordinates[] = R"(
uniform sampler2D radiance;
in vec2 surface;
layout(location = 0) out vec4 color;
void main() {
  vec2 at;
  vec4 read = surface_tap(radiance, surface, int(parameter.x), at);
  color = vec4(at, read.zw);
})";

void check(const Status& status) {
  if (!status.ok()) throw InputError("graphics device", status.detail(), "use a device with float targets and enough memory");
}
template <typename T>
T checked(Result<T> result) {
  check(result.status());
  return result.value();
}

}  // namespace

hal::Texture create_pyramid_texture(hal::Gpu& gpu, SceneDrawer& drawer, const Pyramid& pyramid, hal::TextureFormat format,
                                    std::span<const std::byte> texels) {
  const hal::Texture texture = checked(drawer.create_texture(pyramid.width(), pyramid.height(), format));
  update_pyramid_texture(gpu, texture, pyramid, format, texels);
  return texture;
}

hal::Texture create_pyramid_texture(hal::Gpu& gpu, const Pyramid& pyramid, hal::TextureFormat format, const TextureWraps& wraps) {
  return checked(gpu.create_texture({pyramid.width(), pyramid.height(), static_cast<int>(pyramid.levels().size()), format,
                                     hal::TextureFilter::kTrilinear, wraps.u, wraps.v}));
}

void update_pyramid_texture(hal::Gpu& gpu, hal::Texture texture, const Pyramid& pyramid, hal::TextureFormat format,
                            std::span<const std::byte> texels) {
  const auto texel_bytes = static_cast<size_t>(hal::bytes_per_texel(format));
  int number = 0;
  for (const Pyramid::Level& level : pyramid.levels()) {
    const size_t bytes = static_cast<size_t>(level.width) * static_cast<size_t>(level.height) * texel_bytes;
    check(gpu.update_texture(texture, number++, 0, 0, level.width, level.height,
                             texels.subspan(level.offset * texel_bytes, bytes)));
  }
}

TestRenderer::TestRenderer(hal::Gpu& gpu, const InferenceOptions& options, std::span<const DrawnObject> objects,
                           hal::TextureFormat format)
    : gpu_(&gpu) {
  if (format == hal::TextureFormat::kRgba32f && !gpu.info().float_targets)
    throw InputError("graphics device", "it cannot render to floats", "compile on one that can (OSMesa does)");
  drawer_ = checked(SceneDrawer::create(
      gpu, {options.width, options.height, options.supersampling, format, options.filter, static_cast<int>(std::size(kLayers))}));
  one_tap_ = checked(drawer_.create_program(kOneTap));
  coordinates_ = checked(drawer_.create_program(kCoordinates));
  for (const DrawnObject& object : objects) {
    meshes_.push_back(object.indices.empty()
                          ? DrawMesh{}
                          : checked(drawer_.create_mesh(object.vertices, object.indices, object.culled_index_count)));
  }
}

TestRenderer::~TestRenderer() {
  for (const DrawMesh& mesh : meshes_)
    if (mesh.mesh.id) gpu_->destroy(mesh.mesh);
  gpu_->destroy(one_tap_);
  gpu_->destroy(coordinates_);
  drawer_.destroy();
}

void TestRenderer::render_with(hal::Program program, int tap, const GeometryState& state, std::span<const hal::Texture> textures,
                               std::span<glm::vec4> pixels) {
  check(drawer_.begin());
  for (size_t i = 0; i < meshes_.size(); ++i) {
    if (!meshes_[i].mesh.id || !textures[i].id) continue;
    const bool mirrored = state.mirrored[i] != 0;
    const SurfaceTexture texture{textures[i], state.maps.empty() ? TextureMap::raised() : state.maps[i]};
    check(program.id ? drawer_.draw_with(program, glm::vec4(tap), meshes_[i], state.clip_from_object[i], mirrored, texture)
                     : drawer_.draw(meshes_[i], state.clip_from_object[i], mirrored, {&texture, 1}));
  }
  read_back(pixels);
}

// Bytes are read as bytes and converted here: a device gives numbers of another kind than its target's slowly, if at all.
void TestRenderer::read_back(std::span<glm::vec4> pixels) {
  check(drawer_.end());
  if (format() != hal::TextureFormat::kRgba8)
    return check(gpu_->read_pixels(drawer_.supersampled(), hal::TextureFormat::kRgba32f, std::as_writable_bytes(pixels)));
  bytes_.resize(4 * pixels.size());
  check(gpu_->read_pixels(drawer_.supersampled(), hal::TextureFormat::kRgba8, std::as_writable_bytes(std::span(bytes_))));
  for (size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = glm::vec4(bytes_[4 * i], bytes_[4 * i + 1], bytes_[4 * i + 2], bytes_[4 * i + 3]) / 255.0f;
}

void TestRenderer::render_surfaces(const GeometryState& state, std::span<const std::vector<SurfaceTexture>> surfaces,
                                   std::span<glm::vec4> pixels) {
  check(drawer_.begin());
  for (size_t i = 0; i < meshes_.size(); ++i)
    if (meshes_[i].mesh.id) check(drawer_.draw(meshes_[i], state.clip_from_object[i], state.mirrored[i] != 0, surfaces[i]));
  read_back(pixels);
}

void TestRenderer::render(const GeometryState& state, std::span<const hal::Texture> textures, std::span<glm::vec4> pixels) {
  render_with({}, 0, state, textures, pixels);
}

void TestRenderer::render_tap(const GeometryState& state, std::span<const hal::Texture> textures, int tap,
                              std::span<glm::vec4> pixels) {
  render_with(one_tap_, tap, state, textures, pixels);
}

void TestRenderer::render_coordinates(const GeometryState& state, std::span<const hal::Texture> textures, int tap,
                                      std::span<glm::vec4> pixels) {
  render_with(coordinates_, tap, state, textures, pixels);
}

}  // namespace vitrine
