// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How near the tracer comes to the speed of Embree's bare queries.
#pragma once

#include <cstdint>

#include "host/base/progress.h"
#include "host/scene/scene.h"

namespace vitrine {

struct RayRates {
  struct Side {
    uint64_t rays = 0, shadow_rays = 0;
    // Seconds of one thread's processor time for a bare loop over the queries, and for the tracer with all that it does
    // between them. The best of several rounds that take turns.
    double bare = 0, tracer = 0;
    double relative() const { return bare / tracer; }
  };
  Side picture;  // a whole picture, camera rays, film and all
  Side bounces;  // paths that start at what the camera sees, in directions scattered by the cosine law
  // Seconds of wall time for the picture with one thread and with two; 0 where the machine has but one core.
  double wall_one = 0, wall_two = 0;
};

// Traces the middle of the scene's axes at 256 x 192 with `samples_per_pixel` even samples.
RayRates measure_ray_rates(const Scene& scene, int samples_per_pixel, Progress& progress);

}  // namespace vitrine
