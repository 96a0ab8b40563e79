// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/tracer.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "host/trace/camera_rays.h"
#include "host/trace/film.h"
#include "host/trace/filter_sampler.h"
#include "host/trace/sample_plan.h"

namespace vitrine {

struct Tracer::Impl {
  explicit Impl(const Scene& scene) : world(scene) {}
  trace::World world;
  trace::FilterSampler filter;
};

namespace {

constexpr float kVisible = 4;                  // display whites
constexpr int kFirstSamples = 2, kGrowth = 4;  // samples of a pixel that the first plan is made from; growth until the next

// Everything that tiles share in one frame.
struct Rendering {
  const TraceOptions& options;
  const trace::FilterSampler& filter;
  const trace::CameraRays& camera;
  const trace::Integrator& integrator;
  const trace::SamplePlan& plan;
  trace::Film& film;
  Progress& progress;
  float visible;  // radiance beyond which light is white however it is averaged
};

// Samples of a pixel up to its budget, and at most `limit`.
void render_pixel(const Rendering& r, int x, int y, int limit, trace::TileSums& sums) {
  const int pixel = trace::Film::pixel_in_tile(x, y);
  const trace::PixelBudget& budget = r.plan.at(x, y);
  for (int i = sums.samples(pixel), end = std::min(budget.samples, limit); i < end; ++i) {
    trace::Sampler sampler(static_cast<uint32_t>(x), static_cast<uint32_t>(y), static_cast<uint32_t>(i), r.options.seed);
    sampler.start_vertex(0, 0);
    const glm::vec2 offset = r.filter.sample(sampler.get2d());
    const trace::FirstHit first =
        r.integrator.meet(r.camera.ray(static_cast<float>(x) + 0.5f + offset.x, static_cast<float>(y) + 0.5f + offset.y));
    trace::PixelObject& entry = sums.entry(pixel, first.object);
    const trace::LayerSet layers{entry.diffuse.count < budget.diffuse, entry.specular.count < budget.specular};
    trace::TileSums::add(entry, r.integrator.shade(first, layers, sampler), r.visible);
    sums.count_sample(pixel);
  }
}

void render_tile(const Rendering& r, int tile, int limit) {
  const glm::ivec2 corner = r.film.corner(tile);
  trace::TileSums& sums = r.film.tile(tile);
  for (int y = corner.y; y < std::min(corner.y + trace::kTile, r.options.height); ++y) {
    for (int x = corner.x; x < std::min(corner.x + trace::kTile, r.options.width); ++x) render_pixel(r, x, y, limit, sums);
    r.progress.advance(0);
  }
}

// Of a surface, how flat it is: the length of its vector area in parts of its area. 1 for a sheet, 0 for what is closed.
float flatness(const trace::PosedObject& object) {
  glm::dvec3 sum(0);
  double area = 0;
  for (const trace::ShadingTriangle& t : object.triangles) {
    const auto corner = [&](size_t k) { return object.vertices[t.corner[k]].position; };
    const glm::vec3 cross = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    sum += glm::dvec3(cross);
    area += static_cast<double>(glm::length(cross));
  }
  return area > 0 ? static_cast<float>(glm::length(sum) / area) : 1.0f;
}

// Of all views, those that a texel is seen in, and seen well. Of a sheet they are nearly all; of a convex object that the views
// go around less than half, and few of these see it squarely: on tests/scenes/table a third, as measured by `bench noise`.
std::vector<float> views_of_texels(const trace::World& world, int views) {
  constexpr float kOfRound = 0.33f;
  std::vector<float> result;
  for (const trace::PosedObject& object : world.objects())
    result.push_back(std::max(1.0f, static_cast<float>(views) * (kOfRound + (1 - kOfRound) * flatness(object))));
  return result;
}

trace::NoiseTarget noise_target(const trace::World& world, const TraceOptions& options) {
  const Scene& scene = world.scene();
  trace::NoiseTarget target;
  // Between two renderings there are two errors.
  target.error = options.noise_db > 0 ? std::pow(10, -options.noise_db / 20) / std::sqrt(2.0) : 0;
  target.views = views_of_texels(world, options.views);
  target.max_mean_samples = options.samples_per_pixel;
  target.white = 1 / scene.settings.exposure;
  return target;
}

double decibels(double error) { return error > 0 ? std::min(-20 * std::log10(std::sqrt(2.0) * error), 99.0) : 99.0; }

void report_noise(const trace::SamplePlan& plan, const trace::Film& film, Frame& frame) {
  for (const ObjectFrame& o : frame.objects) {
    const trace::LayerNoise& noise = plan.noise()[static_cast<size_t>(o.object)];
    frame.noise.push_back({o.object, decibels(noise[0]), decibels(noise[1])});
  }
  double rays = 0;
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) rays += film.tile_at(x, y).samples(trace::Film::pixel_in_tile(x, y));
  frame.rays_per_pixel = rays / (static_cast<double>(frame.width) * frame.height);
}

}  // namespace

Tracer::Tracer(const Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}
Tracer::~Tracer() = default;

Frame Tracer::render(const Position& position, const TraceOptions& options, Progress& progress) {
  trace::World& world = impl_->world;
  world.pose(position);
  const trace::Lights lights(world);
  const Scene& scene = world.scene();
  const auto object_count = static_cast<int>(scene.objects.size());
  trace::PathSettings settings;
  settings.max_radiance = scene.settings.max_radiance;
  settings.straight_shadows = !scene.settings.caustics;
  const trace::CameraRays camera(scene.camera, world.current_pose().world_from_camera, options.width, options.height);
  const trace::Integrator integrator(world, lights, settings);
  const trace::NoiseTarget target = noise_target(world, options);
  const bool adaptive = options.noise_db > 0;
  trace::Film film(options.width, options.height);
  trace::SamplePlan plan(options.width, options.height, adaptive ? kFirstSamples : options.samples_per_pixel);
  const Rendering rendering{options, impl_->filter, camera, integrator, plan, film, progress, kVisible * target.white};

  // Passes of growing length: each tells better than the one before where samples are wanting.
  for (int limit = adaptive ? kFirstSamples : options.samples_per_pixel;; limit *= kGrowth) {
    progress.begin("trace", film.tile_count(), 0, "tiles");
    tbb::parallel_for(0, film.tile_count(), [&](int tile) {
      render_tile(rendering, tile, limit);
      progress.advance(1);
    });
    progress.end();
    plan.revise(film, target, object_count);
    if (!adaptive || limit >= plan.most_samples()) break;
  }
  Frame frame = film.frame(options.layers, object_count);
  report_noise(plan, film, frame);
  return frame;
}

}  // namespace vitrine
