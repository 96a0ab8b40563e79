// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Padded, Owen-scrambled (0,2)-sequences: every pair of dimensions of a pixel is a shuffled and scrambled copy of the first
// two Sobol' dimensions (Burley, "Practical Hash-based Owen Scrambling", JCGT 2020; scrambling hash by Vegdahl). A sample is a
// function of (pixel, sample index, seed, dimension) alone, so pictures do not depend on tiles or threads. Deep path vertices,
// where stratification is lost anyway, draw from a hash.
#pragma once

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
  }
  // Uniform in [0, 1). At most 16 calls per vertex.
  float get1d();
  glm::vec2 get2d();

 private:
  static constexpr uint32_t kStratifiedVertices = 4;
  uint32_t pixel_hash_, index_reversed_, index_;
  uint32_t dimension_ = 0;
  bool stratified_ = true;
};

}  // namespace vitrine::trace
