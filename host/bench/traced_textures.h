// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Textures by ray tracing directly into them (Hakura 2001, sections 3.3 and 3.6): rays from the eye towards 3 x 3 points of every
// texel, which a separable Lanczos-windowed sinc of half-width 6 points decimates. What is in front of a point and which way its
// surface faces play no part. How the target filters textures does not either: a peer of texture inference.
#pragma once

#include <cstdint>
#include <memory>

#include "host/base/progress.h"
#include "host/infer/inference.h"
#include "host/infer/verification.h"

namespace vitrine {

struct TextureTraceOptions {
  int width = 640, height = 480;  // of the picture whose eye it is: its pixels tell how coarsely materials' textures are read
  int samples_per_texel = 64;     // shared by its nine points, rounded up
  uint32_t seed = 0;
};

class TextureTracer {
 public:
  // Keeps a reference to `scene`, which is traced at its first sample.
  explicit TextureTracer(const Scene& scene);
  ~TextureTracer();
  // A texture that lies as `placement` says; each layer is cut at display white as inference cuts them. Points that no triangle
  // covers, or behind the camera, are filled from their neighbours. Asks `progress` for an interruption. Threads do not change
  // the result.
  LinearTexture trace(const DrawnObject& object, const Placement& placement, const TextureTraceOptions& options,
                      Progress& progress = silent_progress()) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vitrine
