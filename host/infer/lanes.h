// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What linear operators of inference work on: one number per texel or pixel (float), or 4 K of them side by side, so that
// the colour channels of up to (4 K) / 3 textures share one walk over a rendering matrix. All arithmetic is per channel and
// in the same order whatever K is: a texture does not depend on which others were solved beside it.
#pragma once

#include <cstddef>

namespace vitrine {

template <int K>
struct Lanes {
  using Quad = float __attribute__((vector_size(16)));
  static constexpr int kChannels = 4 * K;
  Quad quads[K] = {};

  float operator[](size_t channel) const { return quads[channel / 4][channel % 4]; }
  void set(size_t channel, float value) { quads[channel / 4][channel % 4] = value; }

  Lanes& operator+=(const Lanes& b) {
    for (int k = 0; k < K; ++k) quads[k] += b.quads[k];
    return *this;
  }
  Lanes& operator-=(const Lanes& b) {
    for (int k = 0; k < K; ++k) quads[k] -= b.quads[k];
    return *this;
  }
  friend Lanes operator+(Lanes a, const Lanes& b) { return a += b; }
  friend Lanes operator-(Lanes a, const Lanes& b) { return a -= b; }
  friend Lanes operator*(Lanes a, const Lanes& b) {
    for (int k = 0; k < K; ++k) a.quads[k] *= b.quads[k];
    return a;
  }
  friend Lanes operator*(float s, Lanes a) {
    for (int k = 0; k < K; ++k) a.quads[k] *= s;
    return a;
  }
};

// float behaves as a single channel.
inline float channel_of(float value, size_t) { return value; }
template <int K>
float channel_of(const Lanes<K>& value, size_t channel) {
  return value[channel];
}
inline void set_channel(float& value, size_t, float channel) { value = channel; }
template <int K>
void set_channel(Lanes<K>& value, size_t at, float channel) {
  value.set(at, channel);
}

template <typename T>
inline constexpr size_t kChannelsOf = T::kChannels;
template <>
inline constexpr size_t kChannelsOf<float> = 1;

}  // namespace vitrine
