// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Sampling of an index in proportion to weights in constant time (Walker 1974, built by Vose's method 1991).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace vitrine::trace {

class AliasTable {
 public:
  AliasTable() = default;
  // Weights >= 0. With a sum of 0 the table is empty.
  explicit AliasTable(std::span<const float> weights);
  bool empty() const { return bins_.empty(); }
  size_t size() const { return bins_.size(); }
  // The index for u in [0, 1); `u` is replaced by a fresh uniform number.
  int sample(float& u) const;
  // Its probability.
  float probability(int index) const { return bins_[static_cast<size_t>(index)].probability; }

 private:
  struct Bin {
    float threshold, probability;
    int32_t alias;
  };
  std::vector<Bin> bins_;
};

}  // namespace vitrine::trace
