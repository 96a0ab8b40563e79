// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/draw/resolve.h"

#include "formats/pixel_filter.h"

namespace vitrine {

// Sample k of pixel 0 has its centre at (k + 1/2) / s, the pixel at 1/2. The samples within the filter's radius of 1 are
// 2 s where s is even, 2 s - 1 where it is odd (one sample then stands on the pixel's centre, and two where the filter is 0).
ResolveTaps resolve_taps(int supersampling) {
  const int s = supersampling;
  ResolveTaps taps{.first = 0, .count = s % 2 ? 2 * s - 1 : 2 * s, .weight = {}};
  taps.first = (s - taps.count) / 2;
  float sum = 0;
  for (int k = 0; k < taps.count; ++k) {
    const float center = (static_cast<float>(taps.first + k) + 0.5f) / static_cast<float>(s);
    taps.weight[static_cast<size_t>(k)] = pixel_filter(center - 0.5f);
    sum += taps.weight[static_cast<size_t>(k)];
  }
  for (float& weight : taps.weight) weight /= sum;
  return taps;
}

}  // namespace vitrine
