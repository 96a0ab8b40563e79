// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The syntax of coded blocks, once for all who need it: the decoder, the encoder, and the encoder's estimates of bits. Each
// function takes a coder with
//   bool bit(int context, bool value)   an adaptive symbol; writers code `value` and return it, readers ignore it
//   bool raw(bool value)                a symbol of one bit
//   bool exhausted()                    readers: no more symbols may be spent
// and goes through the same symbols in the same order. formats/NODE_CODING.md says why each context is what it is.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>

#include "formats/node_coding.h"

namespace vitrine {

// Flags of the cells to the left of and above a block's first texel.
struct Neighbours {
  uint8_t left = kOutsideFlags, above = kOutsideFlags;
  int count(int flag) const { return ((left & flag) != 0) + ((above & flag) != 0); }
  int smaller_than(int size_class) const {
    return ((left >> kFlagSizeShift) < size_class) + ((above >> kFlagSizeShift) < size_class);
  }
};

// Size class: 0 for blocks of 8, 1 of 16, 2 of 32.
inline int size_class(int log2) { return log2 - kMinBlockLog2; }

template <typename Coder>
bool code_skip(Coder& coder, int log2, Neighbours near, bool skipped) {
  return coder.bit(kContextSkip + 3 * size_class(log2) + near.count(kFlagSkipped), skipped);
}

template <typename Coder>
bool code_split(Coder& coder, int log2, Neighbours near, bool split) {
  if (log2 == kMinBlockLog2) return false;
  return coder.bit(kContextSplit + 3 * (size_class(log2) - 1) + near.smaller_than(size_class(log2)), split);
}

template <typename Coder>
Prediction code_prediction(Coder& coder, int log2, Neighbours near, Prediction mode) {
  const int context = kContextPredicted + 3 * size_class(log2) + near.count(kFlagPredicted);
  if (!coder.bit(context, mode != Prediction::kZero)) return Prediction::kZero;
  if (coder.bit(kContextMode, mode == Prediction::kPlanar)) return Prediction::kPlanar;
  if (coder.bit(kContextMode + 1, mode == Prediction::kMean)) return Prediction::kMean;
  return coder.bit(kContextMode + 2, mode == Prediction::kHorizontal) ? Prediction::kHorizontal : Prediction::kVertical;
}

// Of the flag that says whether `plane` has coefficients; bit p of `coded` is plane p, known for the planes before it.
inline int coded_context(int log2, Neighbours near, int plane, int coded) {
  const int known = plane == 0 ? size_class(log2) : plane == 1 ? 3 + (coded & 1) : 5 + ((coded >> 1) & 1);
  return kContextCoded + 3 * known + near.count(kFlagCoded0 << plane);
}

template <typename Coder>
int code_coded_planes(Coder& coder, int log2, Neighbours near, int coded) {
  int result = 0;
  for (int p = 0; p < kNodePlanes; ++p) {
    if (coder.bit(coded_context(log2, near, p, result), (coded >> p) & 1)) result |= 1 << p;
  }
  return result;
}

// A coordinate of the last coefficient: a prefix that names a group of coordinates, then raw bits (H.265, 9.3.3.4).
inline constexpr std::array<uint8_t, 10> kLastGroupStart = {0, 1, 2, 3, 4, 6, 8, 12, 16, 24};
inline int last_group(int coordinate) {
  int group = 0;
  while (group < 9 && kLastGroupStart[static_cast<size_t>(group) + 1] <= coordinate) ++group;
  return group;
}
inline int last_suffix_bits(int group) { return group > 3 ? (group - 2) >> 1 : 0; }

template <typename Coder>
int code_last_prefix(Coder& coder, int log2, int plane, int group) {
  constexpr std::array<int, 3> kOffset = {0, 5, 12};
  const int context = kContextLast + (plane > 0 ? 21 : 0) + kOffset[static_cast<size_t>(size_class(log2))];
  const int last = 2 * log2 - 1;
  int g = 0;
  while (g < last && coder.bit(context + g, g < group)) ++g;
  return g;
}

template <typename Coder>
int code_last_suffix(Coder& coder, int group, int coordinate) {
  const int start = kLastGroupStart[static_cast<size_t>(group)];
  int value = 0;
  for (int b = last_suffix_bits(group) - 1; b >= 0; --b) value |= coder.raw(((coordinate - start) >> b) & 1) << b;
  return start + value;
}

inline int significance_context(int log2, int plane, int diagonal, int sum) {
  const int near = sum < 3 ? sum : sum < 5 ? 3 : 4;
  if (plane > 0) return kContextSignificant + 30 + 5 * (diagonal >= 2) + near;
  return kContextSignificant + 15 * (log2 > kMinBlockLog2) + 5 * ((diagonal >= 2) + (diagonal >= 5)) + near;
}
inline int above_one_context(int plane, int diagonal, LevelTemplate t) {
  const int near = std::min(t.sum - t.count, 4);
  if (plane > 0) return kContextAboveOne + 15 + near;
  return kContextAboveOne + 5 * ((diagonal >= 1) + (diagonal >= 3)) + near;
}
inline int above_two_context(int plane, LevelTemplate t) {
  return kContextAboveTwo + 5 * (plane > 0) + std::min(t.sum - t.count, 4);
}

// Magnitudes from 3 up: Golomb-Rice for small ones, exponential Golomb beyond (H.266, 9.3.3.11), all raw.
inline int rice_parameter(int sum) { return (sum >= 7) + (sum >= 14) + (sum >= 28) + (sum >= 56); }
inline constexpr int kRicePrefixes = 4, kMaxEscapePrefix = 18;

template <typename Coder>
int code_escape(Coder& coder, int rice, int value) {
  const int quotient = value >> rice;
  int prefix = quotient;
  if (quotient >= kRicePrefixes) {
    prefix = kRicePrefixes;
    while ((quotient - kRicePrefixes + 2) >> (prefix - kRicePrefixes + 2)) ++prefix;
  }
  int p = 0;
  while (p < kMaxEscapePrefix && coder.raw(p < prefix)) ++p;
  const int exponent = std::max(0, p - kRicePrefixes + 1);
  const int base = p < kRicePrefixes ? p : kRicePrefixes - 2 + (1 << exponent);
  const int bits = rice + (p < kRicePrefixes ? 0 : exponent);
  const int rest = value - (base << rice);
  int suffix = 0;
  for (int b = bits - 1; b >= 0; --b) suffix |= coder.raw((rest >> b) & 1) << b;
  return (base << rice) + suffix;
}

// Magnitude >= 1 of a coefficient that is known to be nonzero.
template <typename Coder>
int code_magnitude(Coder& coder, int plane, int diagonal, LevelTemplate t, int magnitude) {
  if (!coder.bit(above_one_context(plane, diagonal, t), magnitude > 1)) return 1;
  if (!coder.bit(above_two_context(plane, t), magnitude > 2)) return 2;
  return std::min(3 + code_escape(coder, rice_parameter(t.sum), magnitude - 3), kMaxCoefficientLevel);
}

template <typename Coder>
int code_last(Coder& coder, int log2, int plane, int last) {
  const ScanPosition at = scan_order(log2)[static_cast<size_t>(last)];
  const int group_x = code_last_prefix(coder, log2, plane, last_group(at.x));
  const int group_y = code_last_prefix(coder, log2, plane, last_group(at.y));
  const int x = code_last_suffix(coder, group_x, at.x), y = code_last_suffix(coder, group_y, at.y);
  return scan_index(log2, x, y);
}

// All coefficients of a plane that has some. `Levels` knows or learns them, as CoefficientLevels: `last` (a scan index),
// level(place), found(place, level) for those that are not zero, the last one first, around(place) of those found. Ends early
// where exhausted().
template <typename Coder, typename Levels>
void code_levels(Coder& coder, int log2, int plane, Levels& levels) {
  levels.last = code_last(coder, log2, plane, levels.last);
  levels.find_anew();
  const auto scan = scan_order(log2);
  for (int i = levels.last; i >= 0 && !coder.exhausted(); --i) {
    const ScanPosition at = scan[static_cast<size_t>(i)];
    const LevelTemplate t = levels.around(at);
    const int diagonal = at.x + at.y, level = levels.level(at);
    if (i != levels.last && !coder.bit(significance_context(log2, plane, diagonal, t.sum), level != 0)) continue;
    const int magnitude = code_magnitude(coder, plane, diagonal, t, std::abs(level));
    const bool negative = coder.raw(level < 0);
    levels.found(at, negative ? -magnitude : magnitude);
  }
}

}  // namespace vitrine
