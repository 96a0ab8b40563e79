// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/decode/wavelet_kernels.h"

#include <algorithm>
#include <array>

#include "formats/spiht_coding.h"
#include "formats/wavelet.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "target/decode/wavelet_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace vitrine::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Vectors = hn::ScalableTag<int16_t>;
using Vector = hn::Vec<Vectors>;
constexpr Vectors kVectors;

Vector load(const int16_t* from) { return hn::LoadU(kVectors, from); }

Vector predict(const WaveletRows& rows, size_t i) {
  const Vector near = hn::Add(load(rows.a + i), load(rows.b + i)), far = hn::Add(load(rows.c + i), load(rows.d + i));
  const Vector bend = hn::Add(hn::Sub(near, far), hn::Set(kVectors, 8));
  return hn::Add(hn::ShiftRight<1>(near), hn::ShiftRight<4>(bend));
}
Vector update(const WaveletRows& rows, size_t i) {
  const Vector near = hn::Add(load(rows.a + i), load(rows.b + i)), far = hn::Add(load(rows.c + i), load(rows.d + i));
  const Vector bend = hn::ShiftRight<3>(hn::Sub(near, far));
  return hn::ShiftRight<2>(hn::Add(hn::Add(near, hn::Set(kVectors, 2)), bend));
}

void update_row(const int16_t* low, const WaveletRows& rows, size_t width, int16_t* out) {
  size_t i = 0;
  for (const size_t lanes = hn::Lanes(kVectors); i + lanes <= width; i += lanes)
    hn::StoreU(hn::Sub(load(low + i), update(rows, i)), kVectors, out + i);
  for (; i < width; ++i) out[i] = static_cast<int16_t>(low[i] - wavelet_update(rows.a[i], rows.b[i], rows.c[i], rows.d[i]));
}

void predict_row(const int16_t* high, const WaveletRows& rows, size_t width, int16_t* out) {
  size_t i = 0;
  for (const size_t lanes = hn::Lanes(kVectors); i + lanes <= width; i += lanes)
    hn::StoreU(hn::Add(load(high + i), predict(rows, i)), kVectors, out + i);
  for (; i < width; ++i) out[i] = static_cast<int16_t>(high[i] + wavelet_predict(rows.a[i], rows.b[i], rows.c[i], rows.d[i]));
}

// The same as predict_row, each result after the even sample before it (which is rows.a).
void predict_and_interleave(const int16_t* high, const WaveletRows& rows, size_t count, int16_t* out) {
  size_t i = 0;
  for (const size_t lanes = hn::Lanes(kVectors); i + lanes <= count; i += lanes)
    hn::StoreInterleaved2(load(rows.a + i), hn::Add(load(high + i), predict(rows, i)), kVectors, out + 2 * i);
  for (; i < count; ++i) {
    out[2 * i] = rows.a[i];
    out[2 * i + 1] = static_cast<int16_t>(high[i] + wavelet_predict(rows.a[i], rows.b[i], rows.c[i], rows.d[i]));
  }
}

void to_texels(int16_t* row, size_t width) {
  constexpr int16_t kHalf = 1 << kWaveletFraction >> 1;
  const Vector low = hn::Set(kVectors, -kNodeValueMax), high = hn::Set(kVectors, kNodeValueMax), half = hn::Set(kVectors, kHalf);
  size_t i = 0;
  for (const size_t lanes = hn::Lanes(kVectors); i + lanes <= width; i += lanes) {
    const Vector texels = hn::ShiftRight<kWaveletFraction>(hn::SaturatedAdd(load(row + i), half));
    hn::StoreU(hn::Min(hn::Max(texels, low), high), kVectors, row + i);
  }
  for (; i < width; ++i)
    row[i] = static_cast<int16_t>(std::clamp((row[i] + kHalf) >> kWaveletFraction, -kNodeValueMax, kNodeValueMax));
}

}  // namespace vitrine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vitrine {
namespace {

HWY_EXPORT(update_row);
HWY_EXPORT(predict_row);
HWY_EXPORT(predict_and_interleave);
HWY_EXPORT(to_texels);

// Samples before and after a line, as far as a step reaches.
constexpr int kReach = 2;

}  // namespace

void invert_update_row(const int16_t* low, const WaveletRows& details, int width, int16_t* out) {
  HWY_DYNAMIC_DISPATCH(update_row)(low, details, static_cast<size_t>(width), out);
}

void invert_predict_row(const int16_t* high, const WaveletRows& evens, int width, int16_t* out) {
  HWY_DYNAMIC_DISPATCH(predict_row)(high, evens, static_cast<size_t>(width), out);
}

void invert_line(const int16_t* line, int width, bool detailed, int16_t* out) {
  const int lows = (width + 1) / 2, highs = width / 2;
  if (highs == 0) return static_cast<void>(*out = *line);
  std::array<int16_t, kMaxNodeSize / 2 + 2 * kReach> even_buffer, odd_buffer;
  int16_t *even = even_buffer.data() + kReach, *odd = odd_buffer.data() + kReach;
  if (detailed) {
    std::copy_n(line + lows, highs, odd);
    for (const int i : {-2, -1, highs, highs + 1}) odd[i] = odd[mirrored(2 * i + 1, width) / 2];
    invert_update_row(line, {odd - 1, odd, odd - 2, odd + 1}, lows, even);
  } else {
    std::fill_n(odd, highs, int16_t{0});
    std::copy_n(line, lows, even);
  }
  for (const int i : {-1, lows, lows + 1}) even[i] = even[mirrored(2 * i, width) / 2];
  HWY_DYNAMIC_DISPATCH(predict_and_interleave)(odd, {even, even + 1, even - 1, even + 2}, static_cast<size_t>(highs), out);
  if (lows > highs) out[width - 1] = even[lows - 1];
}

void texels_from_samples(int16_t* row, int width) { HWY_DYNAMIC_DISPATCH(to_texels)(row, static_cast<size_t>(width)); }

}  // namespace vitrine
#endif  // HWY_ONCE
