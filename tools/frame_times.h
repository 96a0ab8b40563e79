// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Percentiles of frame times over a session of any length, in fixed memory: a histogram of 0.01 ms.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace vitrine {

class FrameTimes {
 public:
  void add(int64_t ns) {
    ++counts_[static_cast<size_t>(std::clamp<int64_t>(ns / kBucket, 0, kBuckets - 1))];
    max_ = std::max(max_, ns);
    ++total_;
  }
  // Upper edge of the bucket in which the fraction lies, at most max_ms().
  double percentile_ms(double fraction) const {
    const auto rank = static_cast<int64_t>(std::ceil(fraction * static_cast<double>(total_)));
    int64_t seen = 0;
    for (size_t b = 0; b < kBuckets; ++b)
      if ((seen += counts_[b]) >= rank && rank > 0)
        return b + 1 == kBuckets ? max_ms() : std::min(max_ms(), static_cast<double>(b + 1) * kBucket * 1e-6);
    return 0;
  }
  double max_ms() const { return static_cast<double>(max_) * 1e-6; }

 private:
  static constexpr int64_t kBucket = 10'000, kBuckets = 100'000;
  std::array<uint32_t, kBuckets> counts_{};
  int64_t max_ = 0, total_ = 0;
};

}  // namespace vitrine
