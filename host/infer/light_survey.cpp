// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/light_survey.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "host/base/error.h"

namespace vitrine {
namespace {

constexpr float kOneCode = 3.0e-4f;  // 1 / (255 * 12.92): sRGB is linear near black
constexpr float kLitShare = 1e-3f, kConstant = 1e-3f;
constexpr float kSeen = 1.0f / 16;

LayerLight measure(const ObjectFrame& frame, const std::vector<glm::vec3>& layer, float exposure) {
  LayerLight light{0, 1e30f, 0};
  int64_t seen = 0, lit = 0;
  for (size_t p = 0; p < layer.size(); ++p) {
    const glm::vec3& value = layer[p];
    if (!std::isfinite(value.x + value.y + value.z)) continue;
    const float brightest = std::max({value.x, value.y, value.z});
    if (frame.coverage[p] > kSeen) ++seen, lit += brightest * exposure > kOneCode;
    if (frame.coverage[p] < 0.5f) continue;
    light.low = std::min({light.low, value.x, value.y, value.z});
    light.high = std::max(light.high, brightest);
  }
  light.lit_share = seen ? static_cast<float>(static_cast<double>(lit) / static_cast<double>(seen)) : 0;
  return light;
}

void merge(LayerLight& sum, const LayerLight& light) {
  sum.lit_share = std::max(sum.lit_share, light.lit_share);
  sum.low = std::min(sum.low, light.low);
  sum.high = std::max(sum.high, light.high);
}

std::vector<ObjectLight> measure_frame(const Scene& scene, const Frame& frame) {
  std::vector<ObjectLight> lights(scene.objects.size(), ObjectLight{LayerLight{0, 1e30f, 0}, LayerLight{0, 1e30f, 0}});
  for (const ObjectFrame& object : frame.objects) {
    if (object.object < 0 || static_cast<size_t>(object.object) >= lights.size()) continue;
    lights[static_cast<size_t>(object.object)] = {measure(object, object.diffuse, scene.settings.exposure),
                                                  measure(object, object.specular, scene.settings.exposure)};
  }
  return lights;
}

StoreKey light_key(const Scene& scene, const std::vector<StoreKey>& frames) {
  KeyBuilder key;
  key.text("vitrine light survey 1");
  key.number(static_cast<double>(scene.settings.exposure));
  key.integer(static_cast<int64_t>(scene.objects.size()));
  for (const StoreKey& frame : frames) key.bytes(&frame, sizeof frame);
  return key.finish();
}

constexpr const char* kPlanes[2][3] = {{"diffuse_high", "diffuse_lit", "diffuse_low"},
                                       {"specular_high", "specular_lit", "specular_low"}};

LayeredImage planes_of(const std::vector<ObjectLight>& lights) {
  LayeredImage image{static_cast<int>(lights.size()), 1, {}};
  for (size_t layer = 0; layer < 2; ++layer) {
    for (const char* name : kPlanes[layer]) image.planes.push_back({name, {}});
    for (const ObjectLight& light : lights) {
      image.planes[3 * layer + 0].values.push_back(std::min(light[layer].high, 6.0e4f));
      image.planes[3 * layer + 1].values.push_back(light[layer].lit_share);
      image.planes[3 * layer + 2].values.push_back(std::min(light[layer].low, 6.0e4f));
    }
  }
  return image;
}

std::optional<std::vector<ObjectLight>> lights_of(const LayeredImage& image, size_t objects) {
  if (image.width != static_cast<int>(objects) || image.height != 1) return std::nullopt;
  std::vector<ObjectLight> lights(objects);
  int found = 0;
  for (const LayeredImage::Plane& plane : image.planes)
    for (size_t layer = 0; layer < 2; ++layer)
      for (size_t kind = 0; kind < 3; ++kind) {
        if (plane.name != kPlanes[layer][kind]) continue;
        ++found;
        for (size_t i = 0; i < objects; ++i)
          (kind == 0 ? lights[i][layer].high : kind == 1 ? lights[i][layer].lit_share : lights[i][layer].low) = plane.values[i];
      }
  return found == 6 ? std::optional(lights) : std::nullopt;
}

}  // namespace

Frame load_frame_or_throw(const Store& store, const StoreKey& key, const Scene& scene) {
  if (auto frame = store.load_frame(key, scene)) return std::move(*frame);
  throw InputError("frame " + key.hex(), "it is not in the store, or damaged",
                   "run the same command again, which renders what is missing");
}

std::vector<ObjectLight> survey_light(const Scene& scene, const std::vector<StoreKey>& frames, const Store& store) {
  const StoreKey key = light_key(scene, frames);
  if (const auto image = store.load_planes(key))
    if (auto lights = lights_of(*image, scene.objects.size())) return *lights;
  std::vector<std::vector<ObjectLight>> parts(frames.size());
  tbb::parallel_for(size_t{0}, frames.size(),
                    [&](size_t i) { parts[i] = measure_frame(scene, load_frame_or_throw(store, frames[i], scene)); });
  std::vector<ObjectLight> lights(scene.objects.size(), ObjectLight{LayerLight{0, 1e30f, 0}, LayerLight{0, 1e30f, 0}});
  for (const auto& part : parts)
    for (size_t i = 0; i < lights.size(); ++i)
      for (size_t layer = 0; layer < 2; ++layer) merge(lights[i][layer], part[i][layer]);
  store.save_planes(key, planes_of(lights));
  const auto image = store.load_planes(key);  // as rounded by the store, so that a resumed run decides alike
  if (image)
    if (auto stored = lights_of(*image, scene.objects.size())) return *stored;
  return lights;
}

bool carries_light(const LayerLight& light) { return light.lit_share > kLitShare; }
bool is_constant(const LayerLight& light) { return light.high - light.low <= kConstant * light.high; }

}  // namespace vitrine
