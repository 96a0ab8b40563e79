// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The binary range decoder of nodes (Martin 1979; the arithmetic of LZMA). Past the end it reads zeros, which is what the
// encoder dropped; it never reads out of bounds, and any bytes decode to some symbols.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/node_coding.h"

namespace vitrine {

class RangeDecoder {
 public:
  void start(std::span<const std::byte> bytes) {
    begin_ = at_ = bytes.data();
    end_ = at_ + bytes.size();
    range_ = 0xffffffffu;
    code_ = 0;
    for (int i = 0; i < 4; ++i) code_ = (code_ << 8) | next();
  }

  bool bit(AdaptiveBit& context) {
    const uint32_t bound = (range_ >> 15) * context.probability_of_one();
    const bool one = code_ < bound;
    if (one) {
      range_ = bound;
      context.update(true);
    } else {
      code_ -= bound;
      range_ -= bound;
      context.update(false);
    }
    normalize();
    return one;
  }

  // Without a branch, for nobody can predict it.
  bool raw() {
    range_ >>= 1;
    const auto below = static_cast<uint32_t>((uint64_t{code_} - range_) >> 63);
    code_ -= range_ & (below - 1);
    normalize();
    return below == 0;
  }

  uint64_t bytes_read() const { return static_cast<uint64_t>(at_ - begin_); }

 private:
  uint32_t next() { return at_ < end_ ? static_cast<uint32_t>(*at_++) : 0; }
  // The smallest part of a range is 20 / 2^15 of 2^24, so at most two bytes are needed.
  void normalize() {
    while (range_ < (1u << 24)) {
      range_ <<= 8;
      code_ = (code_ << 8) | next();
    }
  }

  const std::byte *begin_ = nullptr, *at_ = nullptr, *end_ = nullptr;
  uint32_t range_ = 0, code_ = 0;
};

}  // namespace vitrine
