// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The syntax of SPIHT nodes, once for both sides. The walk takes a coder with
//   bool bit(int context, bool value)   an adaptive symbol; writers code `value` and return it, readers ignore it
//   bool raw(bool value)                a symbol of one bit
//   bool ended()                        a reader's bytes do not say what the last symbol was: it counts as not read
//   int bit_planes(plane)               of the largest magnitude
//   int set_top(plane, cell), int descendants_top(plane, cell), int value(plane, place)
// of which the last two lines are what a writer writes; readers return anything.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "formats/spiht_coding.h"

namespace vitrine {

// Coefficients as they become known: bit 15 the sign, below it the magnitude; the bit below the last known one is set, so that
// at any time the value stands in the middle of what it can be.
struct SpihtPlanes {
  std::array<uint16_t*, kNodePlanes> map{};            // SpihtLayout::map_cells each, zero to begin with
  std::array<int16_t*, kNodePlanes> value{};           // texels each, zero to begin with
  std::array<uint8_t, kNodePlanes> detailed_levels{};  // bit k: a coefficient of level k is significant
};

template <typename Coder>
class SpihtWalk {
 public:
  SpihtWalk(const SpihtLayout& layout, SpihtPlanes& planes, Coder& coder) : layout_(layout), planes_(planes), coder_(coder) {}

  // The number of bit planes, at the start of the string, plane by plane.
  int code_bit_planes(int plane) {
    const int count = coder_.bit_planes(plane), context = kSpihtContextPlanes + (plane > 0 ? kMaxBitPlanes : 0);
    int n = 0;
    while (n < kMaxBitPlanes && coder_.bit(context + n, n < count) && !coder_.ended()) ++n;
    return n;
  }

  // One bit of everything below one coefficient of the low band.
  void code_root(int plane, int bit, int x, int y) {
    plane_ = plane;
    bit_ = bit;
    map_ = planes_.map[static_cast<size_t>(plane)];
    values_ = planes_.value[static_cast<size_t>(plane)];
    code_low(x, y);
    if (layout_.levels > 0) code_set(layout_.levels, x, y, false);
  }

 private:
  // What earlier planes of the picture have there.
  uint32_t earlier(size_t cell) const {
    uint32_t flags = plane_ > 0 ? planes_.map[0][cell] : 0;
    return plane_ > 1 ? flags | planes_.map[1][cell] : flags;
  }

  void code_low(int x, int y) {
    const size_t width = static_cast<size_t>(layout_.width[0]), at = static_cast<size_t>(y) * width + static_cast<size_t>(x);
    const int near = (x > 0 && values_[at - 1] != 0) + (y > 0 && values_[at - width] != 0);
    if (values_[at] != 0) return refine(at, near > 0);
    if (coder_.bit(kSpihtContextLow + 3 * (plane_ > 0) + near, known(at) != 0)) become_significant(at);
  }

  void code_set(int level, int x, int y, bool born) {
    const size_t at = layout_.cell(level, x, y), stride = layout_.stride(level);
    const uint16_t* cell = map_ + at;
    bool is_new = false;
    if (!(*cell & kCellSet)) {
      const int near =
          ((cell[-1] & kCellSet) + (cell[1] & kCellSet) + (*(cell - stride) & kCellSet) + (cell[stride] & kCellSet)) / kCellSet;
      const int kind = plane_ == 0 ? std::min(level, 3) - 1 : 3 + ((earlier(at) & kCellSet) != 0);
      const int context = kSpihtContextSet + 6 * kind + 3 * born + std::min(near, 2);
      if (!coder_.bit(context, coder_.set_top(plane_, at) >= bit_)) return;
      map_[at] |= kCellSet;
      is_new = true;
    }
    code_cell(level, x, y, is_new);
    if (level > 1) code_descendants(level, x, y, is_new);
  }

  void code_cell(int level, int x, int y, bool born) {
    const size_t at = layout_.cell(level, x, y), stride = layout_.stride(level);
    const uint16_t *cell = map_ + at, *above = cell - stride, *below = cell + stride;
    const auto of = [](uint32_t flags) { return flags & kCellCoefficients; };
    const uint32_t sides = of(cell[-1]) + of(cell[1]) + of(*above) + of(*below);
    const uint32_t near = 2 * sides + of(above[-1]) + of(above[1]) + of(below[-1]) + of(below[1]);
    const uint32_t parent = level < layout_.levels ? map_[layout_.cell(level + 1, x >> 1, y >> 1)] : 0;
    const uint32_t before = earlier(at);
    for (int o = 0; o < kOrientations; ++o) {
      if (!layout_.has(level, x, y, o)) continue;
      const size_t place = layout_.coefficient(level, x, y, o);
      const uint32_t flag = 1u << (4 * o), neighbours = (near >> (4 * o)) & 15;
      if (map_[at] & flag) {
        refine(place, neighbours > 0);
        continue;
      }
      const int kind = plane_ == 0 ? o == kDiagonalDetail : 2 + ((before & flag) != 0);
      const int context =
          kSpihtContextSignificant + 20 * kind + 10 * born + 5 * ((parent & flag) != 0) + neighbour_class(neighbours);
      if (!coder_.bit(context, known(place) != 0) || !become_significant(place)) continue;
      map_[at] |= static_cast<uint16_t>(flag);
      planes_.detailed_levels[static_cast<size_t>(plane_)] |= static_cast<uint8_t>(1 << level);
    }
  }

  void code_descendants(int level, int x, int y, bool born) {
    const size_t at = layout_.cell(level, x, y), stride = layout_.stride(level);
    const uint16_t* cell = map_ + at;
    bool is_new = false;
    if (!(*cell & kCellDescendants)) {
      const int near = ((cell[-1] & kCellDescendants) + (cell[1] & kCellDescendants) + (*(cell - stride) & kCellDescendants) +
                        (cell[stride] & kCellDescendants)) /
                       kCellDescendants;
      const bool own = (*cell & kCellCoefficients) != 0;
      const int context = kSpihtContextDescendants + 12 * (plane_ > 0) + 6 * own + 3 * born + std::min(near, 2);
      if (!coder_.bit(context, coder_.descendants_top(plane_, at) >= bit_)) return;
      map_[at] |= kCellDescendants;
      is_new = true;
    }
    const int columns = std::min(2, layout_.width[static_cast<size_t>(level) - 1] - 2 * x);
    const int rows = std::min(2, layout_.height[static_cast<size_t>(level) - 1] - 2 * y);
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) code_set(level - 1, 2 * x + i, 2 * y + j, is_new);
  }

  // The writer's magnitude down to this bit.
  int known(size_t place) const {
    const int value = coder_.value(plane_, place);
    return (value < 0 ? -value : value) >> bit_;
  }

  bool become_significant(size_t place) {
    const bool negative = coder_.raw(coder_.value(plane_, place) < 0);
    if (coder_.ended()) return false;
    const uint32_t magnitude = (1u << bit_) | ((1u << bit_) >> 1);
    values_[place] = static_cast<int16_t>(static_cast<uint16_t>(magnitude | (negative ? 0x8000u : 0)));
    return true;
  }

  void refine(size_t place, bool near) {
    const uint32_t value = static_cast<uint16_t>(values_[place]), one = 1u << bit_;
    const bool first = ((value & 0x7fff) >> (bit_ + 1)) == 1;
    const int context = kSpihtContextRefine + 3 * (plane_ > 0) + (first ? near : 2);
    const bool set = coder_.bit(context, known(place) & 1);
    if (coder_.ended()) return;
    values_[place] = static_cast<int16_t>(static_cast<uint16_t>((value & ~one) | (set ? one : 0) | (one >> 1)));
  }

  const SpihtLayout& layout_;
  SpihtPlanes& planes_;
  Coder& coder_;
  int plane_ = 0, bit_ = 0;
  uint16_t* map_ = nullptr;
  int16_t* values_ = nullptr;
};

}  // namespace vitrine
