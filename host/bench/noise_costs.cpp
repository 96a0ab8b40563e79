// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/noise_costs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>

#include "formats/color.h"
#include "hal/backends.h"
#include "host/base/error.h"
#include "host/bench/processor_time.h"
#include "host/compile/compile.h"
#include "host/infer/fields.h"
#include "host/infer/verification.h"

namespace vitrine {
namespace {

constexpr int kSupersampling = 2;
constexpr uint32_t kSeeds[2] = {0, 1};

double srgb(float radiance) { return srgb_from_linear(std::clamp(static_cast<double>(radiance), 0.0, 1.0)); }

// Squared differences of codes, weighted.
struct Difference {
  double sum = 0, weight = 0;
  // Two estimates of a part of `whole`, radiances in parts of display white.
  void add(const glm::vec3& whole, const glm::vec3& a, const glm::vec3& b, double w) {
    const glm::vec3 half = 0.5f * (a - b);
    for (int c = 0; c < 3; ++c) {
      const double d = srgb(whole[c] + half[c]) - srgb(whole[c] - half[c]);
      sum += w * d * d;
    }
    weight += 3 * w;
  }
  double db() const { return sum > 0 && weight > 0 ? std::min(-10 * std::log10(sum / weight), 99.0) : 99.0; }
};

// Differences by object (index into Scene::objects) and layer.
using LayerDifferences = std::map<std::pair<int, Layer>, Difference>;

void compare_frames(const Frame& a, const Frame& b, float exposure, LayerDifferences& differences) {
  for (const ObjectFrame& p : a.objects) {
    const auto other = std::find_if(b.objects.begin(), b.objects.end(), [&](const ObjectFrame& o) { return o.object == p.object; });
    if (other == b.objects.end()) continue;
    const ObjectFrame& q = *other;
    for_each_common_pixel(p, q, [&](size_t i, size_t j) {
      if (p.coverage[i] < 0.5f || q.coverage[j] < 0.5f) return;
      const glm::vec3 whole = 0.5f * exposure * (p.diffuse[i] + p.specular[i] + q.diffuse[j] + q.specular[j]);
      differences[{p.object, Layer::kDiffuse}].add(whole, exposure * p.diffuse[i], exposure * q.diffuse[j], 1);
      differences[{p.object, Layer::kSpecular}].add(whole, exposure * p.specular[i], exposure * q.specular[j], 1);
    });
  }
}

// One seed's frames and textures.
struct Side {
  std::vector<StoreKey> keys;
  Inference inference;
};

// What both sides' frames tell.
struct Traced {
  LayerDifferences differences;
  std::map<std::pair<int, Layer>, std::vector<double>> estimates;  // dB, a frame each
};

// Adds rays and time to `cost`, and keys to `sides`.
Traced trace_sides(const Scene& scene, const TraceOptions& options, const Store& store, Progress& progress, Side sides[2],
                   NoiseCost& cost) {
  const ParameterSpace space = scene.space();
  const StoreKey base = scene_key(scene);
  const auto frames = static_cast<double>(2 * space.sample_count());
  Traced traced;
  Tracer tracer(scene);
  progress.begin("trace", 2 * space.sample_count(), 0, "frames");
  for (int64_t sample = 0; sample < space.sample_count(); ++sample) {
    const Position position = space.position_of(space.index_from_flat(sample));
    Frame pair[2];
    for (size_t s = 0; s < 2; ++s) {
      TraceOptions own = options;
      own.seed = kSeeds[s];
      PartOfStep part(progress);
      const double start = processor_seconds();
      pair[s] = tracer.render(position, own, part);
      cost.seconds += (processor_seconds() - start) / frames;
      cost.rays_per_pixel += pair[s].rays_per_pixel / frames;
      for (const NoiseReport& n : pair[s].noise) {
        traced.estimates[{n.object, Layer::kDiffuse}].push_back(n.diffuse_db);
        traced.estimates[{n.object, Layer::kSpecular}].push_back(n.specular_db);
      }
      sides[s].keys.push_back(frame_key(base, scene, position, own));
      store.save_frame(sides[s].keys.back(), scene, pair[s]);
      progress.advance(1);
    }
    compare_frames(pair[0], pair[1], scene.settings.exposure, traced.differences);
  }
  progress.end();
  return traced;
}

// Which object a pixel shows: the one that covers half of it or more, or -1.
std::vector<int> objects_of_pixels(const Frame& frame) {
  std::vector<int> objects(frame.combined.size(), -1);
  for (const ObjectFrame& o : frame.objects)
    for (int i = 0; i < o.width * o.height; ++i)
      if (o.coverage[static_cast<size_t>(i)] >= 0.5f)
        objects[static_cast<size_t>((o.y + i / o.width) * frame.width + o.x + i % o.width)] = o.object;
  return objects;
}

// A picture drawn with the textures of each layer alone, by Layer: radiances in parts of display white.
using LayerPictures = std::array<std::vector<glm::vec3>, std::size(kLayers)>;

LayerPictures draw_layers(const Scene& scene, const Store& store, const Inference& inference, hal::Gpu& gpu, int64_t sample) {
  LayerPictures pictures;
  for (const Layer layer : kLayers) {
    std::vector<glm::vec3>& picture = pictures[static_cast<size_t>(layer)];
    picture = draw_inferred(store, scene, inference, {&layer, 1}, inference_options(scene, kSupersampling), gpu, sample);
    for (glm::vec3& radiance : picture) radiance *= scene.settings.exposure;
  }
  return pictures;
}

// Between pictures drawn with either side's textures.
struct DrawnDifferences {
  Difference pictures;
  std::map<int, Difference> objects;  // all layers together
  LayerDifferences layers;

  // Light adds up, and so do pictures of layers: their sums are what all layers' textures show together.
  void add(int object, const LayerPictures& a, const LayerPictures& b, size_t pixel) {
    const glm::vec3 p = a[0][pixel] + a[1][pixel], q = b[0][pixel] + b[1][pixel], whole = 0.5f * (p + q);
    pictures.add(whole, p, q, 1);
    if (object < 0) return;
    objects[object].add(whole, p, q, 1);
    for (const Layer layer : kLayers)
      layers[{object, layer}].add(whole, a[static_cast<size_t>(layer)][pixel], b[static_cast<size_t>(layer)][pixel], 1);
  }
};

DrawnDifferences compare_drawn(const Scene& scene, const Store& store, const Side sides[2], hal::Gpu& gpu) {
  DrawnDifferences differences;
  for (int64_t sample = 0; sample < scene.space().sample_count(); ++sample) {
    const auto frame = store.load_frame(sides[0].keys[static_cast<size_t>(sample)], scene);
    if (!frame) throw InputError("work folder", "a frame is gone", "check that it has room, and that nothing else writes to it");
    const std::vector<int> objects = objects_of_pixels(*frame);
    const LayerPictures a = draw_layers(scene, store, sides[0].inference, gpu, sample);
    const LayerPictures b = draw_layers(scene, store, sides[1].inference, gpu, sample);
    for (size_t i = 0; i < objects.size(); ++i) differences.add(objects[i], a, b, i);
  }
  return differences;
}

DrawnDifferences infer_and_compare(const Scene& scene, const Store& store, Progress& progress, Side sides[2]) {
  auto gpu = hal::create_osmesa_gpu(scene.settings.width, scene.settings.height);
  if (!gpu.ok()) throw InputError("OSMesa", gpu.status().detail(), "install the packages of tools/packages.txt");
  for (size_t s = 0; s < 2; ++s)
    sides[s].inference =
        infer_textures(scene, sides[s].keys, store, *gpu.value(), inference_options(scene, kSupersampling), progress);
  return compare_drawn(scene, store, sides, *gpu.value());
}

void report_drawn(const Scene& scene, const DrawnDifferences& drawn, NoiseCost& cost) {
  cost.picture_db = drawn.pictures.db();
  cost.worst_db = 99;
  for (const auto& [object, difference] : drawn.objects) {
    cost.drawn.push_back({scene.objects[static_cast<size_t>(object)].name, difference.db()});
    cost.worst_db = std::min(cost.worst_db, difference.db());
  }
}

// `drawn`: null where nothing was inferred.
void report_layers(const Scene& scene, const Traced& traced, const DrawnDifferences* drawn, NoiseCost& cost) {
  for (const auto& [key, difference] : traced.differences) {
    if (!(difference.sum > 0)) continue;  // a layer without light
    LayerCost layer{scene.objects[static_cast<size_t>(key.first)].name, layer_name(key.second), 0, difference.db(), {}};
    const std::vector<double>& estimates = traced.estimates.at(key);
    for (const double db : estimates) layer.estimated_db += db / static_cast<double>(estimates.size());
    if (drawn) {
      const auto of_layer = drawn->layers.find(key);
      layer.inferred_db = of_layer == drawn->layers.end() ? Difference{}.db() : of_layer->second.db();
    }
    cost.layers.push_back(layer);
  }
}

}  // namespace

NoiseCost measure_noise(const Scene& scene, const TraceOptions& options, bool infer, const Store& store, Progress& progress) {
  NoiseCost cost;
  Side sides[2];
  const Traced traced = trace_sides(scene, options, store, progress, sides, cost);
  std::optional<DrawnDifferences> drawn;
  if (infer) {
    drawn = infer_and_compare(scene, store, progress, sides);
    report_drawn(scene, *drawn, cost);
  }
  report_layers(scene, traced, drawn ? &*drawn : nullptr, cost);
  return cost;
}

}  // namespace vitrine
