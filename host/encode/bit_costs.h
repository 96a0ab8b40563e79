// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What symbols cost in bits, given states of the contexts.
#pragma once

#include <array>
#include <cmath>

#include "formats/node_coding.h"

namespace vitrine {

// -log2(p) for p in 1/32768, in 512 cells.
inline float bits_of_probability(uint32_t p) {
  static const std::array<float, 512> table = [] {
    std::array<float, 512> t;
    for (size_t i = 0; i < t.size(); ++i) t[i] = static_cast<float>(-std::log2((static_cast<double>(i) + 0.5) / 512));
    return t;
  }();
  return table[p >> 6];
}

// The costs of both values of every context, frozen.
class BitCosts {
 public:
  void freeze(const ContextSet& contexts) {
    for (size_t c = 0; c < kContextCount; ++c) {
      const uint32_t p = contexts[c].probability_of_one();
      bits_[c] = {bits_of_probability(32768 - p), bits_of_probability(p)};
    }
  }
  float of(int context, bool value) const { return bits_[static_cast<size_t>(context)][value]; }

 private:
  std::array<std::array<float, 2>, kContextCount> bits_;
};

// A coder for formats/node_syntax.h that only adds up bits.
struct BitCounter {
  const BitCosts& costs;
  float bits = 0;
  bool bit(int context, bool value) {
    bits += costs.of(context, value);
    return value;
  }
  bool raw(bool value) {
    bits += 1;
    return value;
  }
};

}  // namespace vitrine
