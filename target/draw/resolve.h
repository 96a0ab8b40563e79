// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How a supersampled picture becomes pixels: the taps of formats/pixel_filter.h at the centres of its samples.
#pragma once

#include <array>

namespace vitrine {

inline constexpr int kMaxSupersampling = 4, kMaxResolveTaps = 2 * kMaxSupersampling;

// Along one dimension: pixel x takes samples supersampling * x + first + k for k in [0, count), weight[k] each (the weights
// sum to 1; in two dimensions they multiply). Samples beyond the picture's edge drop out and the rest is normalised again.
struct ResolveTaps {
  int first = 0, count = 1;
  std::array<float, kMaxResolveTaps> weight{1};
};

ResolveTaps resolve_taps(int supersampling);  // 1..4

}  // namespace vitrine
