// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/forward_transform.h"

#include <array>
#include <cmath>
#include <cstring>

#include "formats/node_coding.h"
#include "host/encode/block_kernels.h"

namespace vitrine {
namespace {

// Explicit vectors (GCC and Clang split them where the machine's are narrower): left to themselves, compilers vectorize
// these loops along the wrong index.
template <int kLanes>
struct Vector {
  typedef float Type __attribute__((vector_size(4 * kLanes), may_alias, aligned(4)));
};

// Rows are even or odd about their centre, so half of the basis is enough: by row, and transposed by parity.
template <int kLog2>
struct Basis {
  static constexpr int kSize = 1 << kLog2, kHalf = kSize / 2;
  std::array<std::array<float, kHalf>, kSize> rows;
  std::array<std::array<float, kHalf>, kHalf> even, odd;  // [n][k / 2]
  Basis() {
    const float scale = 1 / (64 * std::sqrt(static_cast<float>(kSize)));
    for (size_t k = 0; k < kSize; ++k) {
      for (size_t n = 0; n < kHalf; ++n) {
        rows[k][n] = scale * static_cast<float>(kTransformBasis[k << (kTileLog2 - kLog2)][n]);
        (k & 1 ? odd : even)[n][k / 2] = rows[k][n];
      }
    }
  }
};

// Columns: out[k][x] = sum over y of basis[k][y] * in[y][x], folded at the centre, eight columns at a time.
template <int kLog2>
[[gnu::always_inline]] inline void transform_columns(const Basis<kLog2>& basis, const float* in, float* out) {
  constexpr int kSize = 1 << kLog2, kHalf = kSize / 2;
  using V = typename Vector<8>::Type;
  for (int x = 0; x < kSize; x += 8) {
    V even[kHalf], odd[kHalf];
    for (int y = 0; y < kHalf; ++y) {
      const V a = *reinterpret_cast<const V*>(in + y * kSize + x),
              b = *reinterpret_cast<const V*>(in + (kSize - 1 - y) * kSize + x);
      even[y] = a + b;
      odd[y] = a - b;
    }
    for (int k = 0; k < kSize; k += 2) {
      const auto &e = basis.rows[static_cast<size_t>(k)], &o = basis.rows[static_cast<size_t>(k) + 1];
      V sum_even = {}, sum_odd = {};
      for (int y = 0; y < kHalf; ++y) {
        sum_even += e[static_cast<size_t>(y)] * even[y];
        sum_odd += o[static_cast<size_t>(y)] * odd[y];
      }
      *reinterpret_cast<V*>(out + k * kSize + x) = sum_even;
      *reinterpret_cast<V*>(out + (k + 1) * kSize + x) = sum_odd;
    }
  }
}

template <int kLog2>
[[gnu::always_inline]] inline void transform_row(const Basis<kLog2>& basis, float* row) {
  constexpr int kSize = 1 << kLog2, kHalf = kSize / 2, kLanes = kHalf < 8 ? kHalf : 8, kVectors = kHalf / kLanes;
  using V = typename Vector<kLanes>::Type;
  V even[kVectors] = {}, odd[kVectors] = {};
#pragma GCC unroll 1
  for (int n = 0; n < kHalf; ++n) {
    const float sum = row[n] + row[kSize - 1 - n], difference = row[n] - row[kSize - 1 - n];
    const float *e = basis.even[static_cast<size_t>(n)].data(), *o = basis.odd[static_cast<size_t>(n)].data();
    for (int v = 0; v < kVectors; ++v) {
      even[v] += sum * *reinterpret_cast<const V*>(e + v * kLanes);
      odd[v] += difference * *reinterpret_cast<const V*>(o + v * kLanes);
    }
  }
  float result[2][kHalf];
  std::memcpy(result[0], even, sizeof(even));
  std::memcpy(result[1], odd, sizeof(odd));
  for (int k = 0; k < kHalf; ++k) {
    row[2 * k] = result[0][k];
    row[2 * k + 1] = result[1][k];
  }
}

template <int kLog2>
[[gnu::always_inline]] inline void transform(const Basis<kLog2>& basis, const float* values, float* coefficients) {
  transform_columns<kLog2>(basis, values, coefficients);
  for (int k = 0; k < (1 << kLog2); ++k) transform_row<kLog2>(basis, coefficients + (k << kLog2));
}

template <int kLog2>
const Basis<kLog2>& basis_of() {
  static const Basis<kLog2> basis;
  return basis;
}

VITRINE_WIDE_VECTORS void transform8(const Basis<3>& basis, const float* values, float* out) { transform<3>(basis, values, out); }
VITRINE_WIDE_VECTORS void transform16(const Basis<4>& basis, const float* values, float* out) {
  transform<4>(basis, values, out);
}
VITRINE_WIDE_VECTORS void transform32(const Basis<5>& basis, const float* values, float* out) {
  transform<5>(basis, values, out);
}

}  // namespace

void forward_transform(const float* values, int log2, float* coefficients) {
  if (log2 == 3) return transform8(basis_of<3>(), values, coefficients);
  if (log2 == 4) return transform16(basis_of<4>(), values, coefficients);
  return transform32(basis_of<5>(), values, coefficients);
}

}  // namespace vitrine
