// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/alias_table.h"

#include <algorithm>

namespace vitrine::trace {

AliasTable::AliasTable(std::span<const float> weights) {
  double sum = 0;
  for (const float w : weights) sum += w;
  if (!(sum > 0)) return;
  const size_t n = weights.size();
  bins_.resize(n);
  std::vector<double> scaled(n);
  std::vector<int32_t> small, large;
  for (size_t i = 0; i < n; ++i) {
    bins_[i] = {1, static_cast<float>(weights[i] / sum), static_cast<int32_t>(i)};
    scaled[i] = weights[i] / sum * static_cast<double>(n);
    (scaled[i] < 1 ? small : large).push_back(static_cast<int32_t>(i));
  }
  while (!small.empty() && !large.empty()) {
    const auto low = static_cast<size_t>(small.back());
    const auto high = static_cast<size_t>(large.back());
    small.pop_back();
    bins_[low].threshold = static_cast<float>(scaled[low]);
    bins_[low].alias = static_cast<int32_t>(high);
    scaled[high] -= 1 - scaled[low];
    if (scaled[high] < 1) {
      large.pop_back();
      small.push_back(static_cast<int32_t>(high));
    }
  }
  // What rounding left over: never a bin without weight.
  for (const int32_t i : small) {
    if (weights[static_cast<size_t>(i)] > 0) continue;
    const auto heaviest = std::max_element(weights.begin(), weights.end()) - weights.begin();
    bins_[static_cast<size_t>(i)].threshold = 0;
    bins_[static_cast<size_t>(i)].alias = static_cast<int32_t>(heaviest);
  }
}

int AliasTable::sample(float& u) const {
  const float scaled = u * static_cast<float>(bins_.size());
  const auto i = std::min(static_cast<size_t>(scaled), bins_.size() - 1);
  const float rest = std::min(scaled - static_cast<float>(i), 0x1.fffffep-1f);
  const Bin& bin = bins_[i];
  const bool own = rest < bin.threshold;
  u = std::min(own ? rest / bin.threshold : (rest - bin.threshold) / (1 - bin.threshold), 0x1.fffffep-1f);
  return own ? static_cast<int>(i) : bin.alias;
}

}  // namespace vitrine::trace
