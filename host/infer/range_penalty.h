// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The range regularization (Hakura 2001, equation 3.8): g(x) = 1 / ((x + delta) (1 + delta - x)) keeps texels within the
// interval that a texture can hold. x is in parts of display white.
#pragma once

namespace vitrine {

inline constexpr double kRangeMargin = 1.0 / 512;  // delta

struct RangePenalty {
  double value = 0, slope = 0, curvature = 0;  // g, g', g''
};

// For x in (-delta, 1 + delta), where g is convex.
inline RangePenalty range_penalty(double x) {
  const double low = 1 / (x + kRangeMargin), high = 1 / (1 + kRangeMargin - x);
  const double value = low * high, tilt = high - low;  // g' = g tilt, tilt' = low^2 + high^2
  return {value, value * tilt, value * (tilt * tilt + low * low + high * high)};
}

// What brings the sum of g to about the size of the data term: 1 / (g(0) - g(1/2)).
inline double range_calibration() { return 1 / (range_penalty(0).value - range_penalty(0.5).value); }

}  // namespace vitrine
