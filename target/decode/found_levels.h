// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The coefficients of one plane of a block as they are read. Most places are zero, so what a found one means to the contexts of
// others is added to theirs when it is found, instead of being asked for at every place.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "formats/node_coding.h"

namespace vitrine {

class FoundLevels {
 public:
  struct Found {
    ScanPosition at;
    int16_t level;
  };

  int last = 0;  // read by code_levels before it is known: always a place of the block

  // For code_levels (formats/node_syntax.h). Contexts ask whether a sum reaches 56, and for no larger numbers.
  void find_anew() { count_ = columns_ = rows_ = 0; }
  static constexpr int level(ScanPosition) { return 0; }
  LevelTemplate around(ScanPosition place) const {
    const int packed = around_[index_of(place)];
    return {packed & (kOne - 1), packed >> kCountShift};
  }
  void found(ScanPosition place, int level) {
    found_[count_++] = {place, static_cast<int16_t>(level)};
    columns_ = std::max(columns_, place.x + 1);
    rows_ = std::max(rows_, place.y + 1);
    const auto packed = static_cast<uint16_t>(std::min(std::abs(level), kLargest) | kOne);
    uint16_t* at = &around_[index_of(place)];
    for (const size_t before : kBefore) *(at - before) = static_cast<uint16_t>(*(at - before) + packed);
  }

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  std::span<const Found> all() const { return {found_.data(), count_}; }
  void clear() {
    for (size_t i = 0; i < count_; ++i) {
      uint16_t* at = &around_[index_of(found_[i].at)];
      for (const size_t before : kBefore) *(at - before) = 0;
    }
    count_ = 0;
    last = 0;
  }

 private:
  static constexpr int kCountShift = 12, kOne = 1 << kCountShift, kLargest = 56;  // 5 * 56 < 2^12
  static constexpr size_t kMargin = 2, kStride = kTileSize + kMargin;
  static constexpr size_t kBefore[] = {1, 2, kStride, kStride + 1, 2 * kStride};
  static size_t index_of(ScanPosition place) { return (place.y + kMargin) * kStride + place.x + kMargin; }

  std::array<uint16_t, kStride * kStride> around_{};  // zero between blocks
  std::array<Found, kTileSize * kTileSize> found_;
  size_t count_ = 0;
  int columns_ = 0, rows_ = 0;
};

}  // namespace vitrine
