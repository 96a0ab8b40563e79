// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/node_coding.h"

#include <algorithm>
#include <cstring>

namespace vitrine {
namespace {

constexpr int kFractionLog2 = 3;  // fractional bits of dequantized coefficients, scaled to the amplitude of one texel

// round(65536 / (1 + exp(-0.24 (i - 31.5)))); symmetric, so the upper half follows from the lower.
constexpr std::array<uint16_t, 32> kLogistic = {34,   43,   55,   70,    89,    113,   144,   183,   232,   295,  374,
                                                475,  603,  764,  968,   1226,  1551,  1959,  2470,  3108,  3901, 4880,
                                                6081, 7541, 9296, 11380, 13816, 16614, 19761, 23222, 26933, 30804};
constexpr std::array<uint8_t, kAdaptationSpeeds> kFastShift = {3, 4, 5, 6}, kSlowShift = {5, 6, 7, 9};

template <int kLog2>
constexpr auto make_scan() {
  constexpr int kSize = 1 << kLog2;
  std::array<ScanPosition, kSize * kSize> scan{};
  size_t i = 0;
  for (int d = 0; d < 2 * kSize - 1; ++d) {
    for (int y = std::min(d, kSize - 1); y >= std::max(0, d - kSize + 1); --y) {
      scan[i++] = {static_cast<uint8_t>(d - y), static_cast<uint8_t>(y)};
    }
  }
  return scan;
}
constexpr auto kScan8 = make_scan<3>();
constexpr auto kScan16 = make_scan<4>();
constexpr auto kScan32 = make_scan<5>();

constexpr auto kRamp = [] {
  std::array<int16_t, kTileSize> ramp{};
  for (size_t i = 0; i < kTileSize; ++i) ramp[i] = static_cast<int16_t>(i);
  return ramp;
}();

int16_t clamp16(int value) { return static_cast<int16_t>(std::clamp(value, -32768, 32767)); }

CoefficientExtent extent_of(const CoefficientLevels& levels) {
  CoefficientExtent e;
  for (int i = 0; i < levels.nonzero_count; ++i) {
    e.columns = std::max(e.columns, levels.nonzero[static_cast<size_t>(i)].x + 1);
    e.rows = std::max(e.rows, levels.nonzero[static_cast<size_t>(i)].y + 1);
  }
  return e;
}

// out[n] += factor * basis[n]: |sum| <= 32 * 90 * 2^15 < 2^27.
template <int kCount>
void accumulate(int32_t* out, const int16_t* basis, int16_t factor) {
  for (int n = 0; n < kCount; ++n) out[n] += static_cast<int32_t>(factor) * basis[n];
}

// Vertical pass: column[y] = sum over ky of basis[ky][y] * coefficient[ky], kept with the same fraction bits.
template <int kLog2>
void invert_column(const int16_t* coefficients, int rows, int16_t* column) {
  constexpr int kSize = 1 << kLog2;
  std::array<int32_t, kSize> sum;
  sum.fill(32);
  for (int k = 0; k < rows; ++k) {
    if (coefficients[k] != 0)
      accumulate<kSize>(sum.data(), kTransformBasis[static_cast<size_t>(k) << (kTileLog2 - kLog2)].data(), coefficients[k]);
  }
  for (int y = 0; y < kSize; ++y) column[y] = clamp16(sum[static_cast<size_t>(y)] >> 6);
}

template <int kLog2>
void invert_rows(const int16_t* columns, int count, int16_t* residual) {
  constexpr int kSize = 1 << kLog2;
  constexpr int kShift = 6 + kFractionLog2;
  for (int y = 0; y < kSize; ++y) {
    std::array<int32_t, kSize> sum;
    sum.fill(1 << (kShift - 1));
    for (int k = 0; k < count; ++k) {
      accumulate<kSize>(sum.data(), kTransformBasis[static_cast<size_t>(k) << (kTileLog2 - kLog2)].data(),
                        columns[k * kSize + y]);
    }
    for (int x = 0; x < kSize; ++x) residual[y * kSize + x] = clamp16(sum[static_cast<size_t>(x)] >> kShift);
  }
}

template <int kLog2>
void invert(const int16_t* coefficients, CoefficientExtent extent, int16_t* residual) {
  constexpr int kSize = 1 << kLog2;
  std::array<int16_t, kSize * kSize> half_way;
  for (int k = 0; k < extent.columns; ++k)
    invert_column<kLog2>(coefficients + k * extent.even_rows(), extent.rows, &half_way[static_cast<size_t>(k) * kSize]);
  invert_rows<kLog2>(half_way.data(), extent.columns, residual);
}

// H.265, 8.4.4.2.5, with the block's own corner texels for those that may not be decoded yet.
void predict_planar(const BlockBorder& b, int log2, int16_t* out) {
  const int size = 1 << log2;
  const int right = b.above[static_cast<size_t>(size) - 1], below = b.left[static_cast<size_t>(size) - 1];
  std::array<int32_t, kTileSize> vertical, slope;  // down each column
  for (int x = 0; x < size; ++x) {
    const int above = b.above[static_cast<size_t>(x)];
    vertical[static_cast<size_t>(x)] = (size - 1) * above + below + size;
    slope[static_cast<size_t>(x)] = below - above;
  }
  for (int y = 0; y < size; ++y, out += size) {
    const int left = b.left[static_cast<size_t>(y)], first = (size - 1) * left + right;
    const int16_t across = static_cast<int16_t>(right - left);
    for (int x = 0; x < size; ++x) {
      const size_t i = static_cast<size_t>(x);
      out[x] = static_cast<int16_t>((first + static_cast<int32_t>(kRamp[i]) * across + vertical[i]) >> (log2 + 1));
      vertical[i] += slope[i];
    }
  }
}

}  // namespace

AdaptiveBit adaptive_bit_from_byte(uint8_t byte) {
  const int i = byte >> 2;
  const uint16_t p =
      static_cast<uint16_t>(i < 32 ? kLogistic[static_cast<size_t>(i)] : 65536 - kLogistic[static_cast<size_t>(63 - i)]);
  return {p, p, kFastShift[byte & 3], kSlowShift[byte & 3]};
}

std::span<const uint8_t> default_context_bytes() {
  static constexpr auto kBytes = [] {
    std::array<uint8_t, kContextBytesPerLevel> bytes{};
    for (uint8_t& b : bytes) b = 32 << 2 | 1;
    return bytes;
  }();
  return kBytes;
}

bool load_contexts(std::span<const uint8_t> bytes, ContextSet& contexts) {
  if (bytes.empty()) bytes = default_context_bytes();
  if (bytes.size() != kContextBytesPerLevel) return false;
  for (size_t i = 0; i < bytes.size(); ++i) contexts[i] = adaptive_bit_from_byte(bytes[i]);
  return true;
}

std::span<const ScanPosition> scan_order(int log2) {
  if (log2 == 3) return kScan8;
  if (log2 == 4) return kScan16;
  return kScan32;
}

int scan_index(int log2, int x, int y) {
  const int size = 1 << log2, d = x + y;
  if (d < size) return d * (d + 1) / 2 + (d - y);
  const int after = 2 * size - 1 - d;  // length of this diagonal
  return size * size - after * (after + 1) / 2 + (size - 1 - y);
}

void invert_transform(const int16_t* coefficients, CoefficientExtent extent, int log2, int16_t* residual) {
  if (log2 == 3) return invert<3>(coefficients, extent, residual);
  if (log2 == 4) return invert<4>(coefficients, extent, residual);
  return invert<5>(coefficients, extent, residual);
}

void reconstruct_residual(const CoefficientLevels& levels, int log2, uint16_t step, int16_t* residual) {
  const CoefficientExtent extent = extent_of(levels);
  std::array<int16_t, kTileSize * kTileSize> coefficients;  // only the extent is filled
  std::fill_n(coefficients.begin(), extent.even_columns() * extent.even_rows(), int16_t{0});
  for (int i = 0; i < levels.nonzero_count; ++i) {
    const ScanPosition at = levels.nonzero[static_cast<size_t>(i)];
    coefficients[static_cast<size_t>(at.x * extent.even_rows() + at.y)] = dequantize(levels.at(at.x, at.y), step, log2);
  }
  invert_transform(coefficients.data(), extent, log2, residual);
}

BlockBorder border_of(const NodePlane& plane, int x, int y, int size) {
  BlockBorder b;
  b.has_left = x > 0;
  b.has_above = y > 0;
  const int rows = std::min(size, plane.height - y), columns = std::min(size, plane.width - x);
  const ptrdiff_t stride = plane.width;
  if (b.has_left) {
    const int16_t* at = plane.data + y * stride + x - 1;
    for (int i = 0; i < rows; ++i) b.left[static_cast<size_t>(i)] = at[i * stride];
    std::fill(b.left.begin() + rows, b.left.end(), b.left[static_cast<size_t>(rows) - 1]);
  }
  if (b.has_above) {
    std::copy_n(plane.data + (y - 1) * stride + x, columns, b.above.begin());
    std::fill(b.above.begin() + columns, b.above.end(), b.above[static_cast<size_t>(columns) - 1]);
  }
  if (!b.has_left) b.left.fill(b.has_above ? b.above[0] : int16_t{0});
  if (!b.has_above) b.above.fill(b.has_left ? b.left[0] : int16_t{0});
  return b;
}

int16_t BlockBorder::mean(int log2) const {
  const int size = 1 << log2;
  const auto &first = has_left || !has_above ? left : above, &second = has_above || !has_left ? above : left;
  int sum = size;
  for (size_t i = 0; i < static_cast<size_t>(size); ++i) sum += first[i] + second[i];
  return static_cast<int16_t>(sum >> (log2 + 1));
}

void predict_from(Prediction mode, const BlockBorder& border, int log2, int16_t* prediction) {
  const int size = 1 << log2;
  if (mode == Prediction::kPlanar) return predict_planar(border, log2, prediction);
  const int16_t constant = mode == Prediction::kMean ? border.mean(log2) : int16_t{0};
  for (int row = 0; row < size; ++row, prediction += size) {
    if (mode == Prediction::kVertical)
      std::copy_n(border.above.begin(), size, prediction);
    else
      std::fill_n(prediction, size, mode == Prediction::kHorizontal ? border.left[static_cast<size_t>(row)] : constant);
  }
}

void predict_block(Prediction mode, const NodePlane& plane, int x, int y, int log2, int16_t* prediction) {
  const int size = 1 << log2;
  if (mode == Prediction::kZero) return static_cast<void>(std::fill(prediction, prediction + size * size, int16_t{0}));
  predict_from(mode, border_of(plane, x, y, size), log2, prediction);
}

void store_block(const int16_t* prediction, const int16_t* residual, const NodePlane& plane, int x, int y, int log2) {
  const int size = 1 << log2, columns = std::min(size, plane.width - x), rows = std::min(size, plane.height - y);
  for (int row = 0; row < rows; ++row) {
    int16_t* out = plane.data + static_cast<ptrdiff_t>(y + row) * plane.width + x;
    const int16_t *p = prediction + row * size, *r = residual ? residual + row * size : nullptr;
    for (int i = 0; i < columns; ++i)
      out[i] = static_cast<int16_t>(std::clamp(p[i] + (r ? r[i] : 0), -kNodeValueMax, kNodeValueMax));
  }
}

void store_zero_block(const NodePlane& plane, int x, int y, int log2) {
  const int size = 1 << log2, columns = std::min(size, plane.width - x), rows = std::min(size, plane.height - y);
  for (int row = 0; row < rows; ++row) {
    std::memset(plane.data + static_cast<ptrdiff_t>(y + row) * plane.width + x, 0,
                sizeof(int16_t) * static_cast<size_t>(columns));
  }
}

}  // namespace vitrine
