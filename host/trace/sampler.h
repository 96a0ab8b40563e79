// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Padded (0,2)-sequences: every pair of dimensions of a pixel is a shuffled and digitally shifted copy of the first two Sobol'
// dimensions (Kollig & Keller 2002; the shuffle of indices is an Owen scramble by Vegdahl's hash, as in Burley, "Practical
// Hash-based Owen Scrambling", JCGT 2020). A sample is a function of (pixel, sample index, seed, dimension) alone, so pictures
// do not depend on tiles or threads. Deep path vertices, where stratification is lost anyway, draw from a generator that a hash seeds.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>

namespace vitrine::trace {

// Integer hash with full avalanche (Wellons, "lowbias32").
inline uint32_t hash_u32(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ (x >> 16);
}
inline uint32_t hash_combine(uint32_t a, uint32_t b) { return hash_u32(a ^ (hash_u32(b) + 0x9e3779b9u + (a << 6) + (a >> 2))); }

class Sampler {
 public:
  Sampler(uint32_t x, uint32_t y, uint32_t index, uint32_t seed);
  // Goes to the first dimension of a path vertex. `stream` tells apart the paths that one camera sample splits into.
  void start_vertex(uint32_t stream, uint32_t vertex) {
    dimension_ = (stream << 16) | (vertex << 4);
    stratified_ = vertex < kStratifiedVertices;
    if (!stratified_) state_ = hash_u32(pixel_hash_ ^ (dimension_ * 0x9e3779b9u)) + hash_u32(index_);
  }
  // Uniform in [0, 1). At most 16 calls per vertex.
  float get1d() {
    if (!stratified_) return to_unit(next_random());
    const uint32_t h = next_dimension();
    return to_unit(shuffled(h) ^ (h * 0xb5297a4du));
  }
  glm::vec2 get2d() {
    if (!stratified_) {
      const float x = to_unit(next_random());
      return {x, to_unit(next_random())};
    }
    const uint32_t h = next_dimension();
    const uint32_t x = shuffled(h);
    return {to_unit(x ^ (h * 0xb5297a4du)), to_unit(kSecondDimension[x >> (32 - kTableBits)] ^ (h * 0x1b56c4f5u))};
  }

 private:
  static constexpr uint32_t kTableBits = 12, kTableSize = 1u << kTableBits;
  // Of the Sobol' sequence, by the first: both are 32-bit fractions, and the first's leading bits are the index reversed.
  static const std::array<uint32_t, kTableSize> kSecondDimension;

  static constexpr uint32_t reverse_bits(uint32_t x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    return __builtin_bswap32(x);
  }
  // An Owen scramble of a bit-reversed number: each bit is flipped by a hash of the bits below it.
  static constexpr uint32_t scramble_reversed(uint32_t x, uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    return x ^ (x * 0x53a22864u);
  }
  static float to_unit(uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }
  static std::array<uint32_t, kTableSize> make_second_dimension();
  // PCG RXS M XS 32 (O'Neill 2014).
  uint32_t next_random() {
    state_ = state_ * 747796405u + 2891336453u;
    const uint32_t word = ((state_ >> ((state_ >> 28) + 4)) ^ state_) * 277803737u;
    return (word >> 22) ^ word;
  }
  uint32_t next_dimension() { return hash_u32(pixel_hash_ ^ (dimension_++ * 0x9e3779b9u)); }
  // The first Sobol' dimension at a shuffled index: a bit-reversed index. Indices below a power of two stay below it.
  uint32_t shuffled(uint32_t seed) const { return scramble_reversed(index_reversed_, seed); }

  static constexpr uint32_t kStratifiedVertices = 3;
  uint32_t pixel_hash_, index_reversed_, index_;
  uint32_t dimension_ = 0, state_ = 0;
  bool stratified_ = true;
};

}  // namespace vitrine::trace
