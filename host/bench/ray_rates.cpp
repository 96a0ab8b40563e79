// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/ray_rates.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <limits>
#include <thread>

#include "host/bench/processor_time.h"
#include "host/trace/camera_rays.h"
#include "host/trace/filter_sampler.h"
#include "host/trace/integrator.h"
#include "host/trace/ray_log.h"
#include "host/trace/tracer.h"

namespace vitrine {
namespace {

constexpr int kWidth = 256, kHeight = 192, kRounds = 5;

struct Logs {
  trace::RayLog camera, rest;
};

// The same samples as Tracer's, pixel by pixel.
Logs log_rays(trace::World& world, const Scene& scene, int samples) {
  const trace::Lights lights(world);
  trace::PathSettings settings;
  settings.max_radiance = scene.settings.max_radiance;
  const trace::Integrator integrator(world, lights, settings);
  const trace::CameraRays camera(scene.camera, world.current_pose().world_from_camera, kWidth, kHeight);
  const trace::FilterSampler filter;
  Logs logs;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int s = 0; s < samples; ++s) {
        trace::Sampler sampler(static_cast<uint32_t>(x), static_cast<uint32_t>(y), static_cast<uint32_t>(s), 0);
        sampler.start_vertex(0, 0);
        const glm::vec2 offset = filter.sample(sampler.get2d());
        world.log_rays(&logs.camera);
        const trace::FirstHit first =
            integrator.meet(camera.ray(static_cast<float>(x) + 0.5f + offset.x, static_cast<float>(y) + 0.5f + offset.y));
        world.log_rays(&logs.rest);
        integrator.shade(first, {}, sampler);
      }
    }
  }
  world.log_rays(nullptr);
  return logs;
}

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
  trace::World world(scene);
  world.pose(middle);
  const Logs logs = log_rays(world, scene, samples_per_pixel);
  RayRates rates;
  rates.camera_rays = logs.camera.size();
  rates.shadow_rays = logs.rest.shadows();
  rates.bounce_rays = logs.rest.size() - rates.shadow_rays;

  Tracer tracer(scene);
  TraceOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.samples_per_pixel = samples_per_pixel;
  const auto render = [&](int threads) {
    tbb::task_arena(threads).execute([&] { tracer.render(middle, options); });
  };
  const bool two = std::thread::hardware_concurrency() > 1;
  rates.bare_camera = rates.bare_rest = rates.tracer = rates.wall_one = rates.wall_two = std::numeric_limits<double>::infinity();
  size_t hits = 0;
  progress.begin("measure", kRounds, 0, "rounds");
  for (int round = 0; round < kRounds; ++round) {
    rates.bare_camera = least_time(rates.bare_camera, processor_seconds, [&] { hits += logs.camera.replay(world); });
    rates.bare_rest = least_time(rates.bare_rest, processor_seconds, [&] { hits += logs.rest.replay(world); });
    const double start = wall_seconds();
    rates.tracer = least_time(rates.tracer, processor_seconds, [&] { render(1); });
    rates.wall_one = std::min(rates.wall_one, wall_seconds() - start);
    if (two) rates.wall_two = least_time(rates.wall_two, wall_seconds, [&] { render(2); });
    progress.advance(1);
  }
  progress.end();
  if (!two) rates.wall_two = 0;
  if (hits == 0) rates.bare_rest = 0;  // keeps the loops from being left out
  return rates;
}

}  // namespace vitrine
