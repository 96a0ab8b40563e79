// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A hash of floats' bits, for tables of things that are equal bit for bit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace vitrine {

struct BitHash {
  template <size_t kCount>
  size_t operator()(const std::array<uint32_t, kCount>& key) const {
    uint64_t h = 0x9e3779b97f4a7c15ull;
    for (const uint32_t k : key) h = (h ^ k) * 0xff51afd7ed558ccdull, h ^= h >> 32;
    return static_cast<size_t>(h);
  }
};

}  // namespace vitrine
