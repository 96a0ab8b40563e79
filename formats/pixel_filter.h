// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The pixel filter that ground truth and playback share: a truncated Gaussian, separable, in units of output pixels.
// The tracer samples it (host/trace); the target resolves its supersampled picture with it (target/draw/resolve.h);
// inference filters the rendering matrix with it (host/infer). One definition, so that edges look alike in all three.
#pragma once

#include <cmath>

namespace vitrine {

inline constexpr float kPixelFilterSigma = 0.45f;   // standard deviation before truncation
inline constexpr float kPixelFilterRadius = 1.0f;   // zero beyond; shifted so that it reaches zero continuously

// Weight (not normalized) at offset x from the pixel's centre.
inline float pixel_filter(float x) {
  const auto g = [](float t) { return std::exp(-t * t / (2 * kPixelFilterSigma * kPixelFilterSigma)); };
  return std::fabs(x) >= kPixelFilterRadius ? 0.0f : g(x) - g(kPixelFilterRadius);
}

}  // namespace vitrine
