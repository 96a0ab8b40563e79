// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The path tracer. Embree, next-event estimation with multiple importance sampling, Russian roulette, low-discrepancy
// samples. The result depends on the scene, the position, the options and nothing else: not on the number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "formats/parameter_space.h"
#include "host/base/progress.h"
#include "host/scene/scene.h"
#include "host/trace/frame.h"

namespace vitrine {

struct TraceOptions {
  int width = 640, height = 480;
  // Camera rays of every pixel; with `noise_db` of a pixel in the mean, at most.
  int samples_per_pixel = 64;
  uint32_t seed = 0;   // independent noise for different seeds
  bool layers = true;  // fill Frame::objects
  // 0: every pixel gets the same. Otherwise rays are given where they are needed (trace/sample_plan.h) until two renderings
  // with different seeds would agree to so many decibels in every layer of every object, or the rays are spent. PSNR of
  // sRGB codes; of layers that do not depend on the view after the average over `views` pictures, of which a point of the
  // surface is seen in all or, where it belongs to a round object, in a third.
  double noise_db = 0;
  int views = 1;
};

class Tracer {
 public:
  // Keeps a reference to `scene`. Builds acceleration structures per object once; posing moves instances, and rebuilds the
  // objects that an axis deforms.
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
inline constexpr uint32_t kTracerVersion = 6;

}  // namespace vitrine
