// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/forward_wavelet.h"

#include <algorithm>

#include "formats/wavelet.h"

namespace vitrine {
namespace {

// The samples of a line at a stride, in place; `scratch` holds a line.
void forward_line(int16_t* first, size_t stride, int count, std::vector<int16_t>& scratch) {
  if (count == 1) return;
  for (int i = 0; i < count; ++i) scratch[static_cast<size_t>(i)] = first[static_cast<size_t>(i) * stride];
  const auto at = [&](int i) -> int16_t& { return scratch[static_cast<size_t>(mirrored(i, count))]; };
  for (int i = 1; i < count; i += 2)
    at(i) = static_cast<int16_t>(at(i) - wavelet_predict(at(i - 1), at(i + 1), at(i - 3), at(i + 3)));
  for (int i = 0; i < count; i += 2)
    at(i) = static_cast<int16_t>(at(i) + wavelet_update(at(i - 1), at(i + 1), at(i - 3), at(i + 3)));
  for (int i = 0; i < count; ++i) first[static_cast<size_t>(band_place(i, count)) * stride] = scratch[static_cast<size_t>(i)];
}

}  // namespace

std::vector<int16_t> forward_wavelet(const SpihtLayout& layout, std::span<const int16_t> texels) {
  const size_t width = static_cast<size_t>(layout.width[0]);
  std::vector<int16_t> samples(texels.begin(), texels.end());
  for (int16_t& s : samples) s = static_cast<int16_t>(std::clamp<int>(s, -kNodeValueMax, kNodeValueMax) << kWaveletFraction);
  std::vector<int16_t> scratch(static_cast<size_t>(std::max(layout.width[0], layout.height[0])));
  for (size_t k = 0; k < static_cast<size_t>(layout.levels); ++k) {
    for (int y = 0; y < layout.height[k]; ++y)
      forward_line(&samples[static_cast<size_t>(y) * width], 1, layout.width[k], scratch);
    for (int x = 0; x < layout.width[k]; ++x) forward_line(&samples[static_cast<size_t>(x)], width, layout.height[k], scratch);
  }
  return samples;
}

}  // namespace vitrine
