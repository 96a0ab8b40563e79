// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/coordinate_costs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "formats/color.h"
#include "hal/backends.h"
#include "host/base/error.h"
#include "host/bench/frozen_scene.h"
#include "host/compile/compile.h"
#include "host/infer/parameterization.h"
#include "host/infer/verification.h"
#include "host/verify/reference.h"
#include "host/verify/verify.h"

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

// Squared errors of 8-bit codes over the pixels that an object covers by half or more.
struct Error {
  double squares = 0;
  int64_t values = 0;
};

void add_errors(const Frame& frame, const std::vector<glm::vec3>& drawn, float exposure, std::map<int, Error>& errors) {
  for (const ObjectFrame& o : frame.objects)
    for (int i = 0; i < o.width * o.height; ++i) {
      if (o.coverage[static_cast<size_t>(i)] < 0.5f) continue;
      const auto pixel = static_cast<size_t>((o.y + i / o.width) * frame.width + o.x + i % o.width);
      Error& error = errors[o.object];
      for (int c = 0; c < 3; ++c) {
        const int difference =
            srgb8_from_radiance(exposure * frame.combined[pixel][c]) - srgb8_from_radiance(exposure * drawn[pixel][c]);
        error.squares += difference * difference;
      }
      error.values += 3;
    }
}

// Texels and quality per object with textures of one layout and scale.
std::map<int, TexelPoint> measure(const Scene& scene, const std::vector<StoreKey>& frames, const InferenceOptions& options,
                                  const Store& store, hal::Gpu& gpu, Progress& progress) {
  const Inference inference = infer_textures(scene, frames, store, gpu, options, progress);
  std::map<int, Error> errors;
  for (int64_t sample = 0; sample < scene.space().sample_count(); ++sample) {
    const auto frame = store.load_frame(frames[static_cast<size_t>(sample)], scene);
    if (!frame) throw InputError("work folder", "a frame is gone", "check that it has room, and that nothing else writes to it");
    add_errors(*frame, draw_inferred(store, scene, inference, kLayers, options, gpu, sample), scene.settings.exposure, errors);
  }
  std::map<int, TexelPoint> points;
  for (const Field& field : inference.fields) {
    const int object = inference.objects[static_cast<size_t>(field.drawn_object)].object;
    points[object].texels += static_cast<double>(field.texture_width) * field.texture_height;
  }
  for (auto& [object, point] : points)
    point.psnr_db = psnr_db(errors[object].squares / static_cast<double>(std::max<int64_t>(1, errors[object].values)));
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

}  // namespace

std::vector<CoordinateCost> measure_coordinates(const Scene& whole_scene, int views, int samples_per_pixel, const Store& store,
                                                Progress& progress) {
  const Scene scene = middle_run(whole_scene, views);
  const std::vector<StoreKey> frames = trace_frames(scene, samples_per_pixel, store, progress);
  auto gpu = hal::create_osmesa_gpu(scene.settings.width, scene.settings.height);
  if (!gpu.ok()) throw InputError("OSMesa", gpu.status().detail(), "install the packages of tools/packages.txt");
  std::map<int, CoordinateCost> costs;
  for (const TextureLayout layout : {TextureLayout::kFitted, TextureLayout::kWholeDomain})
    for (const float scale : kScales) {
      InferenceOptions options = inference_options(scene, kSupersampling);
      options.layout = layout;
      options.fit.texels_per_pixel *= scale;
      options.max_texture_size = 4096;
      for (const auto& [object, point] : measure(scene, frames, options, store, *gpu.value(), progress))
        (layout == TextureLayout::kFitted ? costs[object].fitted : costs[object].whole).push_back(point);
    }
  const Pose pose = pose_scene(scene, scene.space().position_of({}));
  std::vector<CoordinateCost> result;
  for (auto& [object, cost] : costs) {
    const auto number = static_cast<size_t>(object);
    cost.object = scene.objects[number].name;
    cost.artists = is_proper_parameterization(scene.objects[number].geometry, world_from_object(scene, pose, object));
    cost.compared = cost.fitted[kOwnScale];
    cost.texels_needed = texels_for(cost.whole, cost.compared.psnr_db);
    result.push_back(std::move(cost));
  }
  return result;
}

}  // namespace vitrine
