// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/base/field_blocks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace vitrine {
namespace {

// The generator of a two-dimensional Fibonacci-like lattice of n points: coprime to n, next to n over the golden ratio.
int64_t lattice_generator(int64_t n) {
  int64_t g = std::max<int64_t>(1, static_cast<int64_t>(std::llround(static_cast<double>(n) * 0.6180339887498949)));
  while (std::gcd(g, n) != 1) ++g;
  return g;
}

}  // namespace

AxisSizes block_size_of(const ParameterSpace& space) {
  AxisSizes size{};
  for (size_t a = 0; a < static_cast<size_t>(space.axis_count); ++a) {
    int n = 1;
    const int samples = space.axes[a].kind == AxisKind::kDiscrete ? 1 : space.axes[a].samples;
    while (n < kMaxBlockSize && n < samples) n *= 2;
    size[a] = static_cast<uint8_t>(n);
  }
  return size;
}

// Korobov's lattice: field i gets (i, i g, i g^2, ...) / n modulo 1 of a block along the axes. So along each axis alone the
// origins are spread evenly, and pairs of axes do not move in step.
AxisSizes stagger_of(int field, int field_count, const ParameterSpace& space, const AxisSizes& block_size) {
  const int64_t n = std::max(1, field_count), g = lattice_generator(n);
  AxisSizes stagger{};
  int64_t multiple = field % n;
  for (int a = 0; a < std::min(space.axis_count, kMaxAxes); ++a) {
    // A block that holds the whole axis needs no second one.
    if (space.axes[a].samples > block_size[a]) stagger[a] = static_cast<uint8_t>(multiple * block_size[a] / n);
    multiple = multiple * g % n;
  }
  return stagger;
}

}  // namespace vitrine
