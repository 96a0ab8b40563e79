// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/filter_sampler.h"

#include <algorithm>

#include "formats/pixel_filter.h"

namespace vitrine::trace {

FilterSampler::FilterSampler() {
  constexpr int kSteps = 8192, kQuantiles = 1024;
  std::vector<double> cumulative(kSteps + 1, 0.0);
  const auto offset_at = [](double step) { return kPixelFilterRadius * (2 * step / kSteps - 1); };
  for (int i = 0; i < kSteps; ++i) cumulative[i + 1] = cumulative[i] + pixel_filter(static_cast<float>(offset_at(i + 0.5)));
  quantiles_.resize(kQuantiles + 1);
  for (int q = 0, i = 0; q <= kQuantiles; ++q) {
    const double target = cumulative[kSteps] * q / kQuantiles;
    while (i + 1 < kSteps && cumulative[i + 1] < target) ++i;
    const double width = cumulative[i + 1] - cumulative[i];
    quantiles_[q] = static_cast<float>(offset_at(i + (width > 0 ? std::clamp((target - cumulative[i]) / width, 0.0, 1.0) : 0.0)));
  }
}

float FilterSampler::invert(float u) const {
  const float scaled = u * static_cast<float>(quantiles_.size() - 1);
  const auto i = std::min(static_cast<size_t>(scaled), quantiles_.size() - 2);
  const float t = scaled - static_cast<float>(i);
  return quantiles_[i] + t * (quantiles_[i + 1] - quantiles_[i]);
}

}  // namespace vitrine::trace
