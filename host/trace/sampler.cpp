// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/sampler.h"

namespace vitrine::trace {

// Pascal's matrix mod 2.
std::array<uint32_t, Sampler::kTableSize> Sampler::make_second_dimension() {
  std::array<uint32_t, kTableSize> table{};
  for (uint32_t i = 0; i < kTableSize; ++i) {
    uint32_t point = 0, column = 1u << 31;
    for (uint32_t bits = i; bits; bits >>= 1, column ^= column >> 1) {
      if (bits & 1) point ^= column;
    }
    table[reverse_bits(i) >> (32 - kTableBits)] = point;
  }
  return table;
}
const std::array<uint32_t, Sampler::kTableSize> Sampler::kSecondDimension = make_second_dimension();

Sampler::Sampler(uint32_t x, uint32_t y, uint32_t index, uint32_t seed)
    : pixel_hash_(hash_combine(hash_combine(x, y), seed)), index_reversed_(reverse_bits(index)), index_(index) {
  // Beyond the table the sequence starts again under other scrambles.
  if (index >= kTableSize) pixel_hash_ = hash_combine(pixel_hash_, index >> kTableBits);
}

}  // namespace vitrine::trace
