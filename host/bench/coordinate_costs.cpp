// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/coordinate_costs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "hal/backends.h"
#include "host/base/error.h"
#include "host/bench/frozen_scene.h"
#include "host/bench/object_pictures.h"
#include "host/compile/compile.h"
#include "host/infer/geometry_states.h"
#include "host/infer/parameterization.h"
#include "host/infer/verification.h"

namespace vitrine {
namespace {

constexpr int kSupersampling = 2;
constexpr size_t kOwnScale = 2;  // of the scene itself, among:
constexpr std::array<float, 5> kScales = {0.5f, 0.71f, 1.0f, 1.41f, 2.0f};

std::vector<StoreKey> trace_frames(const Scene& scene, int samples_per_pixel, const Store& store, Progress& progress) {
  const ParameterSpace space = scene.space();
  const TraceOptions options{scene.settings.width, scene.settings.height, samples_per_pixel, 0, true};
  std::vector<StoreKey> keys;
  Tracer tracer(scene);
  progress.begin("trace", space.sample_count(), 0, "frames");
  for (int64_t sample = 0; sample < space.sample_count(); ++sample) {
    const Position position = space.position_of(space.index_from_flat(sample));
    keys.push_back(frame_key(scene_key(scene), scene, position, options));
    PartOfStep part(progress);
    if (!store.has_frame(keys.back())) store.save_frame(keys.back(), scene, tracer.render(position, options, part));
    progress.advance(1);
  }
  progress.end();
  return keys;
}

// Texels and quality per object with textures of one layout and scale.
std::map<int, TexelPoint> measure(const Scene& scene, const std::vector<StoreKey>& frames, const InferenceOptions& options,
                                  const Store& store, hal::Gpu& gpu, Progress& progress) {
  const Inference inference = infer_textures(scene, frames, store, gpu, options, progress);
  const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
  std::map<int, CodeError> errors;
  for (int64_t sample = 0; sample < scene.space().sample_count(); ++sample) {
    const auto frame = store.load_frame(frames[static_cast<size_t>(sample)], scene);
    if (!frame) throw InputError("work folder", "a frame is gone", "check that it has room, and that nothing else writes to it");
    ObjectDrawer drawer(gpu, options, inference.objects, geometry_state_at(scene, sample, inference.objects, aspect));
    for (size_t i = 0; i < inference.objects.size(); ++i) {
      const int object = inference.objects[i].object;
      const ObjectPicture truth = traced_object(*frame, object, scene.settings.exposure);
      const auto textures = load_object_textures(store, scene, inference, kLayers, static_cast<int>(i), sample);
      errors[object].add(truth, drawn_object(drawer.draw(i, textures), options.width, truth, scene.settings.exposure));
    }
  }
  std::map<int, TexelPoint> points;
  for (const Field& field : inference.fields) {
    const int object = inference.objects[static_cast<size_t>(field.drawn_object)].object;
    points[object].texels += static_cast<double>(field.texture_width) * field.texture_height;
  }
  for (auto& [object, point] : points) point.psnr_db = errors[object].psnr();
  return points;
}

// By interpolation of the logarithm between the first two points that the quality lies between; fewer than the fewest where
// even these are better.
std::optional<double> texels_for(const std::vector<TexelPoint>& points, double psnr_db) {
  if (points.front().psnr_db >= psnr_db) return points.front().texels;
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const TexelPoint &a = points[i], &b = points[i + 1];
    if (b.psnr_db < psnr_db) continue;
    const double t = (psnr_db - a.psnr_db) / (b.psnr_db - a.psnr_db);
    return a.texels * std::pow(b.texels / a.texels, t);
  }
  return std::nullopt;
}

std::vector<TexelPoint>& points_of(CoordinateCost& cost, TextureLayout layout) {
  return layout == TextureLayout::kFitted ? cost.fitted : layout == TextureLayout::kWholeDomain ? cost.whole : cost.square;
}

}  // namespace

std::vector<CoordinateCost> measure_coordinates(const Scene& whole_scene, int views, int samples_per_pixel, const Store& store,
                                                Progress& progress) {
  const Scene scene = middle_run(whole_scene, views);
  const std::vector<StoreKey> frames = trace_frames(scene, samples_per_pixel, store, progress);
  auto gpu = hal::create_osmesa_gpu(scene.settings.width, scene.settings.height);
  if (!gpu.ok()) throw InputError("OSMesa", gpu.status().detail(), "install the packages of tools/packages.txt");
  std::map<int, CoordinateCost> costs;
  for (const TextureLayout layout : {TextureLayout::kFitted, TextureLayout::kWholeDomain, TextureLayout::kSquareDomain})
    for (const float scale : kScales) {
      InferenceOptions options = inference_options(scene, kSupersampling);
      options.layout = layout;
      options.fit.texels_per_pixel *= scale;
      options.max_texture_size = 4096;
      for (const auto& [object, point] : measure(scene, frames, options, store, *gpu.value(), progress))
        points_of(costs[object], layout).push_back(point);
    }
  const Pose pose = pose_scene(scene, scene.space().position_of({}));
  std::vector<CoordinateCost> result;
  for (auto& [object, cost] : costs) {
    const auto number = static_cast<size_t>(object);
    cost.object = scene.objects[number].name;
    cost.artists = is_proper_parameterization(scene.objects[number].geometry, world_from_object(scene, pose, object));
    cost.compared = cost.fitted[kOwnScale];
    cost.whole_needs = texels_for(cost.whole, cost.compared.psnr_db);
    cost.square_needs = texels_for(cost.square, cost.compared.psnr_db);
    result.push_back(std::move(cost));
  }
  return result;
}

}  // namespace vitrine
