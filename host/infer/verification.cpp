// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/verification.h"

#include <algorithm>
#include <span>

#include "formats/companding.h"
#include "host/base/error.h"
#include "host/infer/geometry_states.h"
#include "host/infer/lanes.h"
#include "host/infer/pyramid.h"
#include "host/infer/test_renderer.h"
#include "host/infer/texture_store.h"
#include "target/draw/resolve.h"

namespace vitrine {
namespace {

constexpr uint16_t kHalfOne = 0x3c00;

std::vector<Lanes<1>> all_levels(const Pyramid& pyramid, const LinearTexture& texture) {
  std::vector<Lanes<1>> texels(pyramid.size());
  for (size_t i = 0; i < texture.texels.size(); ++i)
    for (int k = 0; k < 3; ++k) texels[i].set(static_cast<size_t>(k), texture.texels[i][k]);
  for (size_t i = 0; i < texture.texels.size(); ++i) texels[i].set(3, 1);
  pyramid.decimate(texels.data());
  return texels;
}

bool is_one_of(std::span<const Layer> layers, const Field& field) {
  return std::any_of(layers.begin(), layers.end(), [&](Layer layer) { return field.layer == layer_name(layer); });
}

}  // namespace

LinearTexture load_field_texture(const Store& store, const Field& field, int64_t flat) {
  return {field.texture_width, field.texture_height,
          load_solved_texture(store, field.textures.at(static_cast<size_t>(flat))).texels};
}

std::vector<LaidTexture> load_object_textures(const Store& store, const Scene& scene, const Inference& inference,
                                              std::span<const Layer> layers, int drawn_object, int64_t grid_sample) {
  std::vector<LaidTexture> textures;
  for (const Field& field : inference.fields) {
    if (field.drawn_object != drawn_object || !is_one_of(layers, field)) continue;
    const int64_t own = field_sample_of(scene.space(), field.axes, grid_sample);
    textures.push_back({load_field_texture(store, field, own), map_of(field, own)});
  }
  return textures;
}

std::vector<glm::vec4> draw_textures(TestRenderer& renderer, const GeometryState& state,
                                     const std::vector<std::vector<LaidTexture>>& textures) {
  std::vector<std::vector<SurfaceTexture>> surfaces;
  for (const auto& own : textures) {
    surfaces.emplace_back();
    for (const LaidTexture& laid : own)
      surfaces.back().push_back(
          {upload_texture(renderer.gpu(), renderer.drawer(), laid.texture, hal::TextureFormat::kRgba32f), laid.map});
  }
  std::vector<glm::vec4> samples(static_cast<size_t>(renderer.width()) * static_cast<size_t>(renderer.height()));
  renderer.render_surfaces(state, surfaces, samples);
  for (const auto& own : surfaces)
    for (const SurfaceTexture& surface : own) renderer.gpu().destroy(surface.texture);
  return samples;
}

hal::Texture upload_texture(hal::Gpu& gpu, SceneDrawer& drawer, const LinearTexture& texture, hal::TextureFormat format) {
  const Pyramid pyramid(texture.width, texture.height);
  const std::vector<Lanes<1>> texels = all_levels(pyramid, texture);
  if (format == hal::TextureFormat::kRgba32f)
    return create_pyramid_texture(gpu, drawer, pyramid, format, std::as_bytes(std::span(texels)));
  std::vector<uint16_t> halves;
  halves.reserve(4 * texels.size());
  for (const Lanes<1>& texel : texels) {
    for (size_t k = 0; k < 3; ++k) halves.push_back(half_from_float(texel[k]));
    halves.push_back(kHalfOne);
  }
  return create_pyramid_texture(gpu, drawer, pyramid, hal::TextureFormat::kRgba16f, std::as_bytes(std::span(halves)));
}

std::vector<glm::vec4> resolve_linear(std::span<const glm::vec4> samples, int width, int height, int supersampling) {
  const ResolveTaps taps = resolve_taps(supersampling);
  std::vector<glm::vec4> picture(static_cast<size_t>(width) * static_cast<size_t>(height));
  const int columns = width * supersampling, rows = height * supersampling;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      glm::vec4 sum(0);
      float weights = 0;
      for (int j = 0; j < taps.count; ++j)
        for (int i = 0; i < taps.count; ++i) {
          const int sx = x * supersampling + taps.first + i, sy = y * supersampling + taps.first + j;
          if (sx < 0 || sy < 0 || sx >= columns || sy >= rows) continue;
          const float weight = taps.weight[static_cast<size_t>(i)] * taps.weight[static_cast<size_t>(j)];
          sum += weight * samples[static_cast<size_t>(rows - 1 - sy) * static_cast<size_t>(columns) + static_cast<size_t>(sx)];
          weights += weight;
        }
      picture[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)] = sum / weights;
    }
  return picture;
}

std::vector<glm::vec3> draw_inferred(const Store& store, const Scene& scene, const Inference& inference,
                                     std::span<const Layer> layers, const InferenceOptions& options, hal::Gpu& gpu,
                                     int64_t grid_sample) {
  TestRenderer renderer(gpu, options, inference.objects);
  std::vector<std::vector<LaidTexture>> textures;
  for (size_t i = 0; i < inference.objects.size(); ++i)
    textures.push_back(load_object_textures(store, scene, inference, layers, static_cast<int>(i), grid_sample));
  const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
  const auto samples = draw_textures(renderer, geometry_state_at(scene, grid_sample, inference.objects, aspect), textures);
  std::vector<glm::vec3> picture;
  for (const glm::vec4& pixel : resolve_linear(samples, options.width, options.height, options.supersampling))
    picture.emplace_back(pixel);
  return picture;
}

}  // namespace vitrine
