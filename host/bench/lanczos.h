// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

namespace vitrine {

// The sinc function times a window that is a sinc too, as wide as its `lobes` zeros on either side: 0 for |x| >= lobes, zeros at
// the other integers (Duchon, "Lanczos Filtering in One and Two Dimensions", 1979). Not normalized.
inline double lanczos(double x, int lobes) {
  const auto sinc = [](double t) { return std::fabs(t) < 1e-9 ? 1.0 : std::sin(std::numbers::pi * t) / (std::numbers::pi * t); };
  return std::fabs(x) >= lobes ? 0.0 : sinc(x) * sinc(x / lobes);
}

}  // namespace vitrine
