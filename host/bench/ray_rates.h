// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How near the tracer comes to the speed of Embree's bare queries.
#pragma once

#include <cstdint>

#include "host/base/progress.h"
#include "host/scene/scene.h"

namespace vitrine {

struct RayRates {
  uint64_t camera_rays = 0, bounce_rays = 0, shadow_rays = 0;
  // Seconds of one thread's processor time: a bare loop over the camera's queries, one over all others, and the tracer
  // with all that it does between them. The best of several rounds that take turns.
  double bare_camera = 0, bare_rest = 0, tracer = 0;
  // Seconds of wall time of the tracer with one thread and with two; 0 where the machine has but one core.
  double wall_one = 0, wall_two = 0;

  double rays() const { return static_cast<double>(camera_rays + bounce_rays + shadow_rays); }
  // Of the bare loop's speed, that of the tracer: on all rays, and on bounces and shadows alone (all that the tracer does for
  // camera rays beyond their queries is counted as work for the others).
  double share() const { return (bare_camera + bare_rest) / tracer; }
  double share_of_bounces() const { return bare_rest / (tracer - bare_camera); }
};

// Traces the middle of the scene's axes at 256 x 192 with `samples_per_pixel` even samples.
RayRates measure_ray_rates(const Scene& scene, int samples_per_pixel, Progress& progress);

}  // namespace vitrine
