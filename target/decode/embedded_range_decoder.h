// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The binary range decoder of embedded strings: that of range_decoder.h, but one that notices where its bytes end. Bytes past
// the end may have been anything, so a symbol counts only if it is the same whatever they were; the first that is not ends
// the string, and with it every prefix of a string decodes to a prefix of its symbols.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/node_coding.h"

namespace vitrine {

class EmbeddedRangeDecoder {
 public:
  void start(std::span<const std::byte> bytes) {
    at_ = bytes.data();
    end_ = at_ + bytes.size();
    range_ = 0xffffffffu;
    code_ = 0;
    unknown_ = 0;
    ended_ = false;
    for (int i = 0; i < 4; ++i) take_byte();
  }

  // Sticky; symbols from the one that ended on read as zeros.
  bool ended() const { return ended_; }

  bool bit(AdaptiveBit& context) {
    const uint32_t bound = (range_ >> 15) * context.probability_of_one();
    const bool one = code_ < bound;
    if (unknown_ != 0 && !certain(bound, one)) return false;
    if (one) {
      range_ = bound;
    } else {
      code_ -= bound;
      range_ -= bound;
    }
    context.update(one);
    normalize();
    return one;
  }

  bool raw() {
    const uint32_t half = range_ >> 1;
    const bool one = code_ >= half;
    if (unknown_ != 0 && !certain(half, !one)) return false;
    range_ = half;
    if (one) code_ -= half;
    normalize();
    return one;
  }

 private:
  // Whether code_ stays on its side of the bound for all that the unknown bytes can add.
  bool certain(uint32_t bound, bool below) {
    const uint64_t most = static_cast<uint64_t>(code_) + unknown_;
    if (ended_ || (below && most >= bound)) ended_ = true;
    return !ended_;
  }
  void take_byte() {
    const bool there = at_ < end_;
    code_ = (code_ << 8) | (there ? static_cast<uint32_t>(*at_++) : 0);
    unknown_ = (unknown_ << 8) | (there ? 0 : 0xff);
  }
  void normalize() {
    while (range_ < (1u << 24)) {
      range_ <<= 8;
      take_byte();
    }
  }

  const std::byte *at_ = nullptr, *end_ = nullptr;
  uint32_t range_ = 0, code_ = 0;
  uint32_t unknown_ = 0;  // the most that bytes past the end could add to code_
  bool ended_ = false;
};

}  // namespace vitrine
