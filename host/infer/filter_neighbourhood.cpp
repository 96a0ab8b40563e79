// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/filter_neighbourhood.h"

#include <algorithm>
#include <cmath>

namespace vitrine {
namespace {

constexpr double kRounding = 1.0 / 16;  // of sampled places, in texels

// Neighbourhoods follow each other in the order of their texels, so it is enough that neighbours among those solved in parallel
// keep apart: from the left to the right, and around the end where the dimension repeats.
bool is_safe(int spacing, int from, int to, bool same_level, hal::TextureWrap wrap) {
  const auto range = [&](int texel) { return filter_neighbourhood(texel, from, to, same_level, wrap); };
  for (int texel = 0; texel + spacing < from; ++texel)
    if (range(texel).last >= range(texel + spacing).first) return false;
  if (wrap == hal::TextureWrap::kClampToEdge) return true;
  for (int first = 0; first + spacing < from; ++first) {
    const int last = first + (from - 1 - first) / spacing * spacing;
    if (range(last).last >= range(first).first + to) return false;
  }
  return true;
}

}  // namespace

TexelRange filter_neighbourhood(int texel, int from, int to, bool same_level, hal::TextureWrap wrap) {
  TexelRange range{texel - 1, texel + 1};
  if (!same_level) {
    // A texel has weight where its centre is less than a texel away: between (texel - 1/2) / from and (texel + 3/2) / from.
    const double scale = static_cast<double>(to) / from;
    const double low = (texel - 0.5 - kRounding) * scale - 0.5 - kRounding;
    const double high = (texel + 1.5 + kRounding) * scale - 0.5 + kRounding;
    range = {static_cast<int>(std::floor(low)), static_cast<int>(std::floor(high)) + 1};
  }
  if (wrap == hal::TextureWrap::kRepeat) return range;
  return {std::clamp(range.first, 0, to - 1), std::clamp(range.last, 0, to - 1)};
}

int safe_spacing(const std::vector<int>& sizes, int level, hal::TextureWrap wrap) {
  const int finest = std::max(0, level - 1), coarsest = std::min(static_cast<int>(sizes.size()) - 1, level + 1);
  const int size = sizes[static_cast<size_t>(level)];
  const auto safe_at = [&](int spacing) {
    for (int other = finest; other <= coarsest; ++other)
      if (!is_safe(spacing, size, sizes[static_cast<size_t>(other)], other == level, wrap)) return false;
    return true;
  };
  int spacing = 1;
  while (!safe_at(spacing)) ++spacing;  // at the latest `size` of them: one texel has nothing to keep apart from
  return spacing;
}

}  // namespace vitrine
