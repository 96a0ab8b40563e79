// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/mip.h"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace vitrine {
namespace {

float along_x(const MipTaps& taps, const float* row) {
  float sum = taps.weight[0] * row[taps.first];
  for (int k = 1; k < taps.count; ++k) sum += taps.weight[static_cast<size_t>(k)] * row[taps.first + k];
  return sum;
}

void decimate_row(const MipTaps& y, const float* finer, int width, float* coarser) {
  const float* rows = finer + static_cast<ptrdiff_t>(y.first) * width;
  for (int x = 0; x < mip_size(width); ++x) {
    const MipTaps taps = mip_taps(width, x);
    float sum = y.weight[0] * along_x(taps, rows);
    for (int k = 1; k < y.count; ++k)
      sum += y.weight[static_cast<size_t>(k)] * along_x(taps, rows + static_cast<ptrdiff_t>(k) * width);
    coarser[x] = sum;
  }
}

// decimate_row where both dimensions are even: the same operations in the same order, in a form that vectorizes.
void decimate_even_row(const float* rows, int width, float* coarser) {
  const float* below = rows + width;
  for (int x = 0; x < width / 2; ++x)
    coarser[x] = 0.5f * (0.5f * rows[2 * x] + 0.5f * rows[2 * x + 1]) + 0.5f * (0.5f * below[2 * x] + 0.5f * below[2 * x + 1]);
}

}  // namespace

MipTaps mip_taps(int size, int x) {
  if (size <= 1) return {};
  if (size % 2 == 0) return {2 * x, 2, {0.5f, 0.5f, 0}};
  const int m = size / 2;
  const auto n = static_cast<float>(size);
  return {2 * x, 3, {static_cast<float>(m - x) / n, static_cast<float>(m) / n, static_cast<float>(x + 1) / n}};
}

int mip_size(int size) { return std::max(1, size / 2); }

int mip_level_count(int width, int height) { return std::bit_width(static_cast<unsigned>(std::max(width, height))); }

void decimate(const float* finer, int width, int height, float* coarser) {
  const bool even = width % 2 == 0 && height % 2 == 0;
  for (int y = 0; y < mip_size(height); ++y, coarser += mip_size(width)) {
    const MipTaps taps = mip_taps(height, y);
    if (even)
      decimate_even_row(finer + static_cast<ptrdiff_t>(taps.first) * width, width, coarser);
    else
      decimate_row(taps, finer, width, coarser);
  }
}

}  // namespace vitrine
