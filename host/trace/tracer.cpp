// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/tracer.h"

#include <tbb/parallel_for.h>

#include "host/trace/camera_rays.h"
#include "host/trace/film.h"
#include "host/trace/filter_sampler.h"
#include "host/trace/ray_counts.h"

namespace vitrine {

using trace::FilmRecord;

struct Tracer::Impl {
  explicit Impl(const Scene& scene) : world(scene) {}
  trace::World world;
  trace::FilterSampler filter;
};

namespace {

constexpr int kTile = 16;

// Everything that tiles share in one frame.
struct Rendering {
  const TraceOptions& options;
  const trace::FilterSampler& filter;
  const trace::CameraRays& camera;
  const trace::Integrator& integrator;
  const trace::RayCounts& counts;
  Frame& frame;
  std::vector<std::vector<FilmRecord>>& records;
  Progress& progress;
};

void render_pixel(const Rendering& r, int x, int y, trace::PixelSums& sums) {
  sums.clear();
  for (int s = 0, count = r.counts.at(x, y); s < count; ++s) {
    trace::Sampler sampler(static_cast<uint32_t>(x), static_cast<uint32_t>(y), static_cast<uint32_t>(s), r.options.seed);
    sampler.start_vertex(0, 0);
    const glm::vec2 offset = r.filter.sample(sampler.get2d());
    const trace::Ray ray = r.camera.ray(static_cast<float>(x) + 0.5f + offset.x, static_cast<float>(y) + 0.5f + offset.y);
    sums.add(r.integrator.trace(ray, sampler));
  }
}

void render_tile(const Rendering& r, int tile) {
  const int columns = (r.options.width + kTile - 1) / kTile;
  const int x0 = tile % columns * kTile, y0 = tile / columns * kTile;
  trace::PixelSums sums;
  for (int y = y0; y < std::min(y0 + kTile, r.options.height); ++y) {
    for (int x = x0; x < std::min(x0 + kTile, r.options.width); ++x) {
      render_pixel(r, x, y, sums);
      r.frame.combined[static_cast<size_t>(y) * static_cast<size_t>(r.options.width) + static_cast<size_t>(x)] = sums.mean();
      if (r.options.layers) sums.append_records(x, y, r.records[static_cast<size_t>(tile)]);
    }
    r.progress.advance(0);
  }
}

}  // namespace

Tracer::Tracer(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}
Tracer::~Tracer() = default;

Frame Tracer::render(const Position& position, const TraceOptions& options, Progress& progress) {
  trace::World& world = impl_->world;
  world.pose(position);
  const trace::Lights lights(world);
  const Scene& scene = world.scene();
  Frame frame;
  frame.width = options.width;
  frame.height = options.height;
  frame.combined.resize(static_cast<size_t>(options.width) * static_cast<size_t>(options.height));
  const int tiles = ((options.width + kTile - 1) / kTile) * ((options.height + kTile - 1) / kTile);
  std::vector<std::vector<FilmRecord>> records(static_cast<size_t>(tiles));
  trace::PathSettings settings;
  settings.max_radiance = scene.settings.max_radiance;
  const trace::CameraRays camera(scene.camera, world.current_pose().world_from_camera, options.width, options.height);
  const trace::Integrator integrator(world, lights, settings);
  const trace::RayCounts counts(integrator, camera, options.width, options.height, options.samples_per_pixel,
                                options.specular_factor);
  const Rendering rendering{options, impl_->filter, camera, integrator, counts, frame, records, progress};
  progress.begin("trace", tiles, 0, "tiles");
  tbb::parallel_for(0, tiles, [&](int tile) {
    render_tile(rendering, tile);
    progress.advance(1);
  });
  progress.end();
  if (options.layers) frame.objects = trace::objects_from_records(records, static_cast<int>(scene.objects.size()));
  return frame;
}

}  // namespace vitrine
