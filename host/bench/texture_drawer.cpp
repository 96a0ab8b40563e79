// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/texture_drawer.h"

#include <vector>

#include "hal/backends.h"
#include "host/base/error.h"
#include "host/infer/fields.h"
#include "host/infer/geometry_states.h"
#include "host/verify/reference.h"

namespace vitrine {

TextureDrawer::TextureDrawer(const Scene& scene, const Inference& inference, const InferenceOptions& options)
    : scene_(scene), inference_(inference), options_(options) {
  auto gpu = hal::create_osmesa_gpu(options.width, options.height);
  if (!gpu.ok()) throw InputError("OSMesa", gpu.status().detail(), "install the packages of tools/packages.txt");
  gpu_ = std::move(gpu.value());
  renderer_ = std::make_unique<TestRenderer>(*gpu_, options_, inference.objects);
}

Picture TextureDrawer::draw(int64_t sample, const Textures& textures) {
  std::vector<std::vector<LaidTexture>> laid(inference_.objects.size());
  for (size_t f = 0; f < inference_.fields.size(); ++f) {
    const Field& field = inference_.fields[f];
    const int64_t own = field_sample_of(scene_.space(), field.axes, sample);
    laid[static_cast<size_t>(field.drawn_object)].push_back({textures(f, own), map_of(field, own)});
  }
  const float aspect = static_cast<float>(options_.width) / static_cast<float>(options_.height);
  const auto samples = draw_textures(*renderer_, geometry_state_at(scene_, sample, inference_.objects, aspect), laid);
  Picture picture{options_.width, options_.height, {}};
  for (const glm::vec4& pixel : resolve_linear(samples, options_.width, options_.height, options_.supersampling))
    for (int c = 0; c < 3; ++c) picture.rgb.push_back(srgb8_from_radiance(pixel[c] * scene_.settings.exposure));
  return picture;
}

}  // namespace vitrine
