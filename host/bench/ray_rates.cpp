// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/ray_rates.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <thread>

#include "host/bench/processor_time.h"
#include "host/trace/camera_rays.h"
#include "host/trace/filter_sampler.h"
#include "host/trace/integrator.h"
#include "host/trace/ray_log.h"
#include "host/trace/tracer.h"
#include "host/trace/warp.h"

namespace vitrine {
namespace {

constexpr int kWidth = 256, kHeight = 192, kRounds = 5;

trace::Sampler sampler_of(int x, int y, int index) {
  return {static_cast<uint32_t>(x), static_cast<uint32_t>(y), static_cast<uint32_t>(index), 0};
}

struct Start {
  trace::Ray ray;
  trace::Sampler sampler;
};

// Everything to trace the middle of the scene's axes, ray by ray.
struct Bench {
  Bench(const Scene& scene, const Position& position, int samples)
      : world(posed(scene, position)),
        lights(*world),
        integrator(*world, lights, {scene.settings.max_radiance}),
        camera(scene.camera, world->current_pose().world_from_camera, kWidth, kHeight) {
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (int s = 0; s < samples; ++s) log_sample(x, y, s);
    world->log_rays(&bounces);
    trace_bounces();
    world->log_rays(nullptr);
  }

  static std::unique_ptr<trace::World> posed(const Scene& scene, const Position& position) {
    auto world = std::make_unique<trace::World>(scene);
    world->pose(position);
    return world;
  }

  // The same as Tracer's, and the start of a path from where it met something.
  void log_sample(int x, int y, int index) {
    trace::Sampler sampler = sampler_of(x, y, index);
    sampler.start_vertex(0, 0);
    const glm::vec2 offset = filter.sample(sampler.get2d());
    world->log_rays(&picture);
    const trace::FirstHit first =
        integrator.meet(camera.ray(static_cast<float>(x) + 0.5f + offset.x, static_cast<float>(y) + 0.5f + offset.y));
    integrator.shade(first, {}, sampler);
    world->log_rays(nullptr);
    if (!first.solid) return;
    const trace::Surface& s = first.surface;
    const glm::vec3 normal = s.back ? -s.geometric : s.geometric;
    sampler.start_vertex(9, 0);
    const glm::vec3 direction = trace::Basis(normal).to_world(trace::cosine_hemisphere(sampler.get2d()));
    starts.push_back({{s.position + s.margin * normal, direction}, sampler_of(x, y, index)});
    starts.back().ray.spread = 0.2f;
  }

  void trace_bounces() {
    for (Start start : starts) light += integrator.incoming(start.ray, start.sampler);
  }

  std::unique_ptr<trace::World> world;
  trace::Lights lights;
  trace::Integrator integrator;
  trace::CameraRays camera;
  trace::FilterSampler filter;
  trace::RayLog picture, bounces;
  std::vector<Start> starts;
  glm::vec3 light{0};  // the sum: no loop may be left out
};

template <typename Work>
double least_time(double so_far, double (*clock)(), const Work& work) {
  const double start = clock();
  work();
  return std::min(so_far, clock() - start);
}

}  // namespace

RayRates measure_ray_rates(const Scene& scene, int samples_per_pixel, Progress& progress) {
  const ParameterSpace space = scene.space();
  Position middle{};
  for (int a = 0; a < space.axis_count; ++a) middle[static_cast<size_t>(a)] = 0.5f;
  Bench bench(scene, middle, samples_per_pixel);
  Tracer tracer(scene);
  TraceOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.samples_per_pixel = samples_per_pixel;
  const auto render = [&](int threads) { tbb::task_arena(threads).execute([&] { tracer.render(middle, options); }); };

  constexpr double kUnmeasured = std::numeric_limits<double>::infinity();
  const bool two = std::thread::hardware_concurrency() > 1;
  RayRates rates{{bench.picture.size(), bench.picture.shadows(), kUnmeasured, kUnmeasured},
                 {bench.bounces.size(), bench.bounces.shadows(), kUnmeasured, kUnmeasured},
                 kUnmeasured,
                 two ? kUnmeasured : 0};
  size_t hits = 0;
  progress.begin("measure", kRounds, 0, "rounds");
  for (int round = 0; round < kRounds; ++round) {
    rates.picture.bare = least_time(rates.picture.bare, processor_seconds, [&] { hits += bench.picture.replay(*bench.world); });
    rates.bounces.bare = least_time(rates.bounces.bare, processor_seconds, [&] { hits += bench.bounces.replay(*bench.world); });
    rates.bounces.tracer = least_time(rates.bounces.tracer, processor_seconds, [&] { bench.trace_bounces(); });
    const double start = wall_seconds();
    rates.picture.tracer = least_time(rates.picture.tracer, processor_seconds, [&] { render(1); });
    rates.wall_one = std::min(rates.wall_one, wall_seconds() - start);
    if (two) rates.wall_two = least_time(rates.wall_two, wall_seconds, [&] { render(2); });
    progress.advance(1);
  }
  progress.end();
  if (hits == 0 && bench.light == glm::vec3(0)) return {};  // a scene of nothing
  return rates;
}

}  // namespace vitrine
