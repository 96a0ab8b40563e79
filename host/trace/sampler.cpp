// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/sampler.h"

#include <array>

namespace vitrine::trace {
namespace {

constexpr uint32_t kTableBits = 12;
constexpr uint32_t kTableSize = 1u << kTableBits;

constexpr uint32_t reverse_bits(uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  return __builtin_bswap32(x);
}

// An Owen scramble of a bit-reversed number: each bit is flipped by a hash of the bits below it.
inline uint32_t scramble_reversed(uint32_t x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// The second Sobol' dimension (Pascal's matrix mod 2), bit-reversed.
std::array<uint32_t, kTableSize> make_second_dimension() {
  std::array<uint32_t, kTableSize> table{};
  for (uint32_t i = 0; i < kTableSize; ++i) {
    uint32_t point = 0, column = 1u << 31;
    for (uint32_t bits = i; bits; bits >>= 1, column ^= column >> 1) {
      if (bits & 1) point ^= column;
    }
    table[i] = reverse_bits(point);
  }
  return table;
}
const std::array<uint32_t, kTableSize> kSecondDimension = make_second_dimension();

inline float to_unit(uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

}  // namespace

Sampler::Sampler(uint32_t x, uint32_t y, uint32_t index, uint32_t seed)
    : pixel_hash_(hash_combine(hash_combine(x, y), seed)), index_reversed_(reverse_bits(index)), index_(index) {
  // Beyond the table the sequence starts again under other scrambles.
  if (index >= kTableSize) pixel_hash_ = hash_combine(pixel_hash_, index >> kTableBits);
}

float Sampler::get1d() {
  const uint32_t h = hash_u32(pixel_hash_ ^ (dimension_++ * 0x9e3779b9u));
  if (!stratified_) return to_unit(hash_combine(h, index_));
  const uint32_t i = reverse_bits(scramble_reversed(index_reversed_, h)) & (kTableSize - 1);
  return to_unit(reverse_bits(scramble_reversed(i, h * 0xb5297a4du + 1)));
}

glm::vec2 Sampler::get2d() {
  const uint32_t h = hash_u32(pixel_hash_ ^ (dimension_++ * 0x9e3779b9u));
  if (!stratified_) {
    const uint32_t a = hash_combine(h, index_);
    return {to_unit(a), to_unit(hash_u32(a + 0x68e31da4u))};
  }
  const uint32_t i = reverse_bits(scramble_reversed(index_reversed_, h)) & (kTableSize - 1);
  const uint32_t x = reverse_bits(scramble_reversed(i, hash_u32(h + 1)));
  const uint32_t y = reverse_bits(scramble_reversed(kSecondDimension[i], hash_u32(h + 2)));
  return {to_unit(x), to_unit(y)};
}

}  // namespace vitrine::trace
