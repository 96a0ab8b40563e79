// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/decode/block_kernels.h"

#include <array>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "target/decode/block_kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once for each kind of vectors.
#include <hwy/highway.h>

// What all kinds share.
#ifndef VITRINE_BLOCK_KERNELS_TABLES
#define VITRINE_BLOCK_KERNELS_TABLES
namespace vitrine {
namespace {

// Two rows of the basis side by side, as instructions want them that multiply and add pairs of 16-bit numbers: at pair p and
// texel n the values of rows 2 p and 2 p + 1.
template <int kLog2>
struct PairedBasis {
  static constexpr size_t kSize = size_t{1} << kLog2;
  alignas(64) std::array<int16_t, kSize * kSize> values;
  const int16_t* at(int pair, size_t texel) const { return &values[2 * (static_cast<size_t>(pair) * kSize + texel)]; }
};

template <int kLog2>
constexpr PairedBasis<kLog2> make_paired_basis() {
  constexpr size_t kSize = size_t{1} << kLog2;
  PairedBasis<kLog2> paired{};
  for (size_t k = 0; k < kSize; ++k)
    for (size_t n = 0; n < kSize; ++n)
      paired.values[2 * (k / 2 * kSize + n) + k % 2] = kTransformBasis[k << (kTileLog2 - kLog2)][n];
  return paired;
}
template <int kLog2>
constexpr PairedBasis<kLog2> kPairedBasis = make_paired_basis<kLog2>();

alignas(64) constexpr auto kRamp = [] {
  std::array<int32_t, kTileSize> ramp{};
  for (size_t i = 0; i < kTileSize; ++i) ramp[i] = static_cast<int32_t>(i);
  return ramp;
}();

// Two neighbouring coefficients of a column.
inline int32_t pair_at(const int16_t* coefficients) {
  int32_t pair;
  std::memcpy(&pair, coefficients, sizeof(pair));
  return pair;
}

}  // namespace
}  // namespace vitrine
#endif  // VITRINE_BLOCK_KERNELS_TABLES

HWY_BEFORE_NAMESPACE();
namespace vitrine {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128  // by the definitions themselves

void predict_any(Prediction mode, const BlockBorder& border, int log2, int16_t* out, ptrdiff_t stride) {
  std::array<int16_t, kTileSize * kTileSize> prediction;
  predict_from(mode, border, log2, prediction.data());
  for (int row = 0; row < 1 << log2; ++row)
    std::copy_n(&prediction[static_cast<size_t>(row << log2)], 1 << log2, out + row * stride);
}

void add_any(const int16_t* coefficients, CoefficientExtent extent, int log2, int16_t* out, ptrdiff_t stride) {
  const int size = 1 << log2;
  std::array<int16_t, kTileSize * kTileSize> residual;
  invert_transform(coefficients, extent, log2, residual.data());
  for (int row = 0; row < size; ++row)
    for (int x = 0; x < size; ++x) {
      int16_t& texel = out[row * stride + x];
      texel = static_cast<int16_t>(
          std::clamp(texel + residual[static_cast<size_t>((row << log2) + x)], -kNodeValueMax, kNodeValueMax));
    }
}

#else

namespace hn = hwy::HWY_NAMESPACE;

// As many values of a block's row as fit a vector.
template <int kLog2>
using Wide = hn::CappedTag<int32_t, (1 << kLog2)>;
template <int kLog2>
using Narrow = hn::CappedTag<int16_t, (1 << kLog2)>;

// A sum of products of pairs; some machines keep it in two parts.
template <class D32>
class PairSum {
 public:
  using D16 = hn::Repartition<int16_t, D32>;
  using Basis = hn::Vec<D16>;
  PairSum() : first_(hn::Zero(D32())), second_(hn::Zero(D32())) {}
  void add(Basis basis, int32_t pair) {
    const Basis factor = hn::BitCast(D16(), hn::Set(D32(), pair));
    first_ = hn::ReorderWidenMulAccumulate(D32(), basis, factor, first_, second_);
  }
  // Rounded, without the lowest bits.
  template <int kShift>
  hn::Vec<D32> shifted() const {
    const auto sum = hn::RearrangeToOddPlusEven(first_, second_);
    return hn::ShiftRight<kShift>(hn::Add(sum, hn::Set(D32(), 1 << (kShift - 1))));
  }

 private:
  hn::Vec<D32> first_, second_;
};

template <int kLog2>
typename PairSum<Wide<kLog2> >::Basis load_basis(int pair, size_t texel) {
  return hn::LoadU(typename PairSum<Wide<kLog2> >::D16(), kPairedBasis<kLog2>.at(pair, texel));
}

// A column's values at every y, as 16-bit numbers in the lower halves of 32.
template <class D32>
hn::Vec<D32> clamp16(hn::Vec<D32> v) {
  return hn::Min(hn::Max(v, hn::Set(D32(), -32768)), hn::Set(D32(), 32767));
}

// Columns 2 c and 2 c + 1 become pairs, one for each y.
template <int kLog2>
void invert_two_columns(const int16_t* left_column, const int16_t* right_column, int row_pairs, int32_t* pairs) {
  using D32 = Wide<kLog2>;
  constexpr size_t kSize = size_t{1} << kLog2;
  const D32 d;
  for (size_t y = 0; y < kSize; y += hn::Lanes(d)) {
    PairSum<D32> left, right;
    for (int p = 0; p < row_pairs; ++p) {
      const auto basis = load_basis<kLog2>(p, y);
      left.add(basis, pair_at(left_column + 2 * p));
      right.add(basis, pair_at(right_column + 2 * p));
    }
    const auto low = hn::And(clamp16<D32>(left.template shifted<6>()), hn::Set(d, 0xffff));
    const auto high = hn::ShiftLeft<16>(clamp16<D32>(right.template shifted<6>()));
    hn::StoreU(hn::Or(low, high), d, pairs + y);
  }
}

// A vector's worth of a row: what is there, and the residual.
template <class D16>
void add_clamped(D16 d, hn::Vec<D16> residual, int16_t* out) {
  const auto sum = hn::SaturatedAdd(hn::LoadU(d, out), residual);
  hn::StoreU(hn::Min(hn::Max(sum, hn::Set(d, -kNodeValueMax)), hn::Set(d, kNodeValueMax)), d, out);
}

// Rows of the residual, four at a time so that they share what is loaded of the basis.
template <int kLog2>
void add_rows(const int32_t* pairs, int column_pairs, int16_t* out, ptrdiff_t stride) {
  using D32 = Wide<kLog2>;
  constexpr size_t kSize = size_t{1} << kLog2, kRows = 4;
  const hn::Rebind<int16_t, D32> narrow;
  for (size_t x = 0; x < kSize; x += hn::Lanes(D32()))
    for (size_t y = 0; y < kSize; y += kRows) {
      PairSum<D32> sums[kRows];
      for (int p = 0; p < column_pairs; ++p) {
        const auto basis = load_basis<kLog2>(p, x);
        for (size_t r = 0; r < kRows; ++r) sums[r].add(basis, pairs[static_cast<size_t>(p) * kSize + y + r]);
      }
      for (size_t r = 0; r < kRows; ++r)
        add_clamped(narrow, hn::DemoteTo(narrow, sums[r].template shifted<9>()),
                    out + static_cast<ptrdiff_t>(y + r) * stride + x);
    }
}

// The same row of the residual everywhere: the coefficients lie in one row.
template <int kLog2>
void add_same_row(const int16_t* coefficients, CoefficientExtent extent, int16_t* out, ptrdiff_t stride) {
  using D32 = Wide<kLog2>;
  constexpr size_t kSize = size_t{1} << kLog2;
  const hn::Rebind<int16_t, D32> narrow;
  for (size_t x = 0; x < kSize; x += hn::Lanes(D32())) {
    PairSum<D32> sum;
    for (int c = 0; c < extent.columns; c += 2) {
      const auto left = static_cast<uint16_t>(coefficients[c * extent.even_rows()]),
                 right = static_cast<uint16_t>(coefficients[(c + 1) * extent.even_rows()]);
      sum.add(load_basis<kLog2>(c / 2, x), static_cast<int32_t>(left | static_cast<uint32_t>(right) << 16));
    }
    const auto residual = hn::DemoteTo(narrow, sum.template shifted<9>());
    for (size_t y = 0; y < kSize; ++y) add_clamped(narrow, residual, out + static_cast<ptrdiff_t>(y) * stride + x);
  }
}

template <int kLog2>
void add_constant(int16_t coefficient, int16_t* out, ptrdiff_t stride) {
  constexpr size_t kSize = size_t{1} << kLog2;
  const Narrow<kLog2> d;
  const auto residual = hn::Set(d, static_cast<int16_t>((64 * coefficient + 256) >> 9));
  for (size_t y = 0; y < kSize; ++y, out += stride)
    for (size_t x = 0; x < kSize; x += hn::Lanes(d)) add_clamped(d, residual, out + x);
}

template <int kLog2>
void add(const int16_t* coefficients, CoefficientExtent extent, int16_t* out, ptrdiff_t stride) {
  constexpr size_t kSize = size_t{1} << kLog2;
  if (extent.columns == 1 && extent.rows == 1) return add_constant<kLog2>(coefficients[0], out, stride);
  // The first row of the basis is 64 everywhere: what the columns would do with it is undone by their rounding.
  if (extent.rows == 1) return add_same_row<kLog2>(coefficients, extent, out, stride);
  alignas(64) std::array<int32_t, kSize / 2 * kSize> pairs;
  const int column_pairs = extent.even_columns() / 2, row_pairs = extent.even_rows() / 2;
  for (int c = 0; c < column_pairs; ++c) {
    const int16_t* left = coefficients + 2 * c * extent.even_rows();
    invert_two_columns<kLog2>(left, left + extent.even_rows(), row_pairs, &pairs[static_cast<size_t>(c) * kSize]);
  }
  add_rows<kLog2>(pairs.data(), column_pairs, out, stride);
}

template <int kLog2>
void fill_row(int16_t value, int16_t* out) {
  const Narrow<kLog2> d;
  for (size_t x = 0; x < (size_t{1} << kLog2); x += hn::Lanes(d)) hn::StoreU(hn::Set(d, value), d, out + x);
}

// As predict_block: every row adds to what the one above it had.
template <int kLog2>
void predict_planar(const BlockBorder& border, int16_t* out, ptrdiff_t stride) {
  using D32 = Wide<kLog2>;
  constexpr int kSize = 1 << kLog2;
  const D32 d;
  const hn::Rebind<int16_t, D32> narrow;
  const int right = border.above[kSize - 1], below = border.left[kSize - 1];
  for (size_t x = 0; x < kSize; x += hn::Lanes(d)) {
    const auto above = hn::PromoteTo(d, hn::LoadU(narrow, &border.above[x])), ramp = hn::LoadU(d, &kRamp[x]);
    const auto slope = hn::Sub(hn::Set(d, below), above);
    auto vertical = hn::Add(hn::Sub(hn::ShiftLeft<kLog2>(above), above), hn::Set(d, below + kSize + right));
    for (int y = 0; y < kSize; ++y) {
      const int left = border.left[static_cast<size_t>(y)];
      const auto across = hn::Mul(ramp, hn::Set(d, right - left));
      const auto sum = hn::Add(hn::Add(across, vertical), hn::Set(d, (kSize - 1) * left));
      hn::StoreU(hn::DemoteTo(narrow, hn::ShiftRight<kLog2 + 1>(sum)), narrow, out + y * stride + x);
      vertical = hn::Add(vertical, slope);
    }
  }
}

template <int kLog2>
void predict(Prediction mode, const BlockBorder& border, int16_t* out, ptrdiff_t stride) {
  constexpr size_t kSize = size_t{1} << kLog2;
  if (mode == Prediction::kPlanar) return predict_planar<kLog2>(border, out, stride);
  const int16_t mean = mode == Prediction::kMean ? border.mean(kLog2) : int16_t{0};
  for (size_t y = 0; y < kSize; ++y, out += stride) {
    if (mode == Prediction::kVertical)
      std::memcpy(out, border.above.data(), kSize * sizeof(int16_t));
    else
      fill_row<kLog2>(mode == Prediction::kMean ? mean : border.left[y], out);
  }
}

void predict_any(Prediction mode, const BlockBorder& border, int log2, int16_t* out, ptrdiff_t stride) {
  if (log2 == 3) return predict<3>(mode, border, out, stride);
  if (log2 == 4) return predict<4>(mode, border, out, stride);
  return predict<5>(mode, border, out, stride);
}

void add_any(const int16_t* coefficients, CoefficientExtent extent, int log2, int16_t* out, ptrdiff_t stride) {
  if (log2 == 3) return add<3>(coefficients, extent, out, stride);
  if (log2 == 4) return add<4>(coefficients, extent, out, stride);
  return add<5>(coefficients, extent, out, stride);
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace vitrine
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vitrine {

HWY_EXPORT(predict_any);
HWY_EXPORT(add_any);

void predict_texels(Prediction mode, const BlockBorder& border, int log2, int16_t* out, ptrdiff_t stride) {
  HWY_DYNAMIC_DISPATCH(predict_any)(mode, border, log2, out, stride);
}

void add_residual(const int16_t* coefficients, CoefficientExtent extent, int log2, int16_t* out, ptrdiff_t stride) {
  HWY_DYNAMIC_DISPATCH(add_any)(coefficients, extent, log2, out, stride);
}

}  // namespace vitrine
#endif  // HWY_ONCE
