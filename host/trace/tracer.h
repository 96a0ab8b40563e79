// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The path tracer. Embree, next-event estimation with multiple importance sampling, Russian roulette, low-discrepancy
// samples. The result depends on the scene, the position, the options and nothing else: not on the number of threads.
#pragma once

#include <cstdint>
#include <memory>

#include "formats/parameter_space.h"
#include "host/base/progress.h"
#include "host/scene/scene.h"
#include "host/trace/frame.h"

namespace vitrine {

struct TraceOptions {
  int width = 640, height = 480;
  int samples_per_pixel = 64;
  uint32_t seed = 0;   // independent noise for different seeds
  bool layers = true;  // fill Frame::objects
  // Pixels that may show reflections or refraction get this many times as many camera rays, four times that where they show
  // little else: for frames whose textures will be inferred. 1: the same everywhere.
  int specular_factor = 1;
};

class Tracer {
 public:
  // Keeps a reference to `scene`. Builds acceleration structures per object once; posing moves instances.
  explicit Tracer(const Scene& scene);
  ~Tracer();
  // Renders the scene at `position`, tiles in parallel on TBB's current arena: one stage of `progress`, which is asked for an
  // interruption after every row of a tile. Throws what it throws.
  Frame render(const Position& position, const TraceOptions& options, Progress& progress = silent_progress());

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Changes whenever the tracer would give other pictures for the same input; part of every frame's key.
inline constexpr uint32_t kTracerVersion = 5;

}  // namespace vitrine
