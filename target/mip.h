// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// MIP levels by decimation. Only the finest level of a texture is coded; the target makes the others (Hakura 2001, section
// 3.6), and inference knows this very filter (its unknowns are the finest level alone).
//
// Level l+1 has max(1, floor(w/2)) x max(1, floor(h/2)) texels. Texel (x, y) is the mean of the source texels under its
// footprint: an even dimension takes the pair 2x, 2x+1; an odd dimension of n > 1 takes 2x, 2x+1, 2x+2 with the weights of
// the exact footprint (polyphase box: m = floor(n/2); weights (m-x)/n, m/n, (x+1)/n); a dimension of 1 takes its only texel.
#pragma once

#include <array>

namespace vitrine {

struct MipTaps {
  int first = 0;                         // source index of weight[0]
  int count = 1;                         // 1..3
  std::array<float, 3> weight{1, 0, 0};  // sums to 1
};

// Taps along one dimension: source size `size` (> 1 unless it is already 1), destination index x.
MipTaps mip_taps(int size, int x);
int mip_size(int size);                      // max(1, floor(size / 2))
int mip_level_count(int width, int height);  // down to 1 x 1

// One level from the next finer one of width x height: mip_size(width) * mip_size(height) values. Each is the taps' sum along
// x for each source row, lowest index first, and then the taps' sum of those along y: the same floats on every machine.
void decimate(const float* finer, int width, int height, float* coarser);

}  // namespace vitrine
