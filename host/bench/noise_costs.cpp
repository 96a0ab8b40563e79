// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/noise_costs.h"

#include <algorithm>
#include <cmath>
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

// Which object a pixel shows: the one that covers half of it or more, or -1.
std::vector<int> objects_of_pixels(const Frame& frame) {
  std::vector<int> objects(frame.combined.size(), -1);
  for (const ObjectFrame& o : frame.objects)
    for (int i = 0; i < o.width * o.height; ++i)
      if (o.coverage[static_cast<size_t>(i)] >= 0.5f)
        objects[static_cast<size_t>((o.y + i / o.width) * frame.width + o.x + i % o.width)] = o.object;
  return objects;
}

// Pictures drawn with either side's textures, by object; -1: whole pictures.
std::map<int, Difference> compare_drawn(const Scene& scene, const Store& store, const Side sides[2], hal::Gpu& gpu) {
  const InferenceOptions options = inference_options(scene, kSupersampling);
  const float exposure = scene.settings.exposure;
  std::map<int, Difference> differences;
  for (int64_t sample = 0; sample < scene.space().sample_count(); ++sample) {
    const auto frame = store.load_frame(sides[0].keys[static_cast<size_t>(sample)], scene);
    if (!frame) throw InputError("work folder", "a frame is gone", "check that it has room, and that nothing else writes to it");
    const std::vector<int> objects = objects_of_pixels(*frame);
    const auto a = draw_inferred(store, scene, sides[0].inference, options, gpu, sample);
    const auto b = draw_inferred(store, scene, sides[1].inference, options, gpu, sample);
    for (size_t i = 0; i < a.size(); ++i) {
      for (const int object : {-1, objects[i]}) {
        differences[object].add(0.5f * exposure * (a[i] + b[i]), exposure * a[i], exposure * b[i], 1);
        if (objects[i] < 0) break;
      }
    }
  }
  return differences;
}

}  // namespace

NoiseCost measure_noise(const Scene& scene, const TraceOptions& options, bool infer, const Store& store, Progress& progress) {
  const ParameterSpace space = scene.space();
  const StoreKey base = scene_key(scene);
  const auto frames = static_cast<double>(2 * space.sample_count());
  NoiseCost cost;
  LayerDifferences in_frames;
  std::map<std::pair<int, Layer>, std::vector<double>> estimates;
  Side sides[2];
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
        estimates[{n.object, Layer::kDiffuse}].push_back(n.diffuse_db);
        estimates[{n.object, Layer::kSpecular}].push_back(n.specular_db);
      }
      sides[s].keys.push_back(frame_key(base, scene, position, own));
      store.save_frame(sides[s].keys.back(), scene, pair[s]);
      progress.advance(1);
    }
    compare_frames(pair[0], pair[1], scene.settings.exposure, in_frames);
  }
  progress.end();

  if (infer) {
    auto gpu = hal::create_osmesa_gpu(scene.settings.width, scene.settings.height);
    if (!gpu.ok()) throw InputError("OSMesa", gpu.status().detail(), "install the packages of tools/packages.txt");
    for (Side& side : sides)
      side.inference = infer_textures(scene, side.keys, store, *gpu.value(), inference_options(scene, kSupersampling), progress);
    cost.worst_db = 99;
    for (const auto& [object, difference] : compare_drawn(scene, store, sides, *gpu.value())) {
      if (object < 0) {
        cost.picture_db = difference.db();
      } else {
        cost.drawn.push_back({scene.objects[static_cast<size_t>(object)].name, difference.db()});
        cost.worst_db = std::min(cost.worst_db, difference.db());
      }
    }
  }
  for (const auto& [key, difference] : in_frames) {
    if (!(difference.sum > 0)) continue;  // a layer without light
    const std::vector<double>& e = estimates[key];
    LayerCost layer{scene.objects[static_cast<size_t>(key.first)].name, layer_name(key.second), 0, difference.db()};
    for (const double db : e) layer.estimated_db += db / static_cast<double>(e.size());
    cost.layers.push_back(layer);
  }
  return cost;
}

}  // namespace vitrine
