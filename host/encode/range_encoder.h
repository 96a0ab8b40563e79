// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The binary range encoder that target/decode/range_decoder.h undoes (Martin 1979; the carry handling of LZMA).
#pragma once

#include <cstdint>
#include <vector>

#include "formats/node_coding.h"

namespace vitrine {

class RangeEncoder {
 public:
  // Appends to `out`.
  explicit RangeEncoder(std::vector<uint8_t>& out) : out_(out), start_(out.size()) {}

  void bit(AdaptiveBit& context, bool one) {
    const uint32_t bound = (range_ >> 15) * context.probability_of_one();
    if (one) {
      range_ = bound;
    } else {
      low_ += bound;
      range_ -= bound;
    }
    context.update(one);
    normalize();
  }

  void raw(bool one) {
    range_ >>= 1;
    if (one) low_ += range_;
    normalize();
  }

  // Ends with the number inside the last interval that has most zeros at its end, and drops the zero bytes: the decoder
  // reads zeros past the end. At least one byte stays, since no bytes means the all-zero node.
  void finish() {
    for (int bits = 32; bits >= 0; --bits) {
      const uint64_t mask = (uint64_t{1} << bits) - 1, candidate = (low_ + mask) & ~mask;
      if (candidate - low_ < range_) {
        low_ = candidate;
        break;
      }
    }
    for (int i = 0; i < 5; ++i) shift_low();
    while (out_.size() > start_ && out_.back() == 0) out_.pop_back();
    if (out_.size() == start_) out_.push_back(0);
  }

  // Ends with the fewest bytes after which no byte can change a symbol (target/decode/embedded_range_decoder.h).
  void finish_embedded() {
    int bits = 32;
    while (bits > 0 && interval_start(bits) + ((uint64_t{1} << bits) - 1) - low_ >= range_) bits -= 8;
    low_ = interval_start(bits);
    for (int i = 0; i < 5 - bits / 8; ++i) shift_low();
  }

 private:
  // The least multiple of 2^bits that is not below low_.
  uint64_t interval_start(int bits) const {
    const uint64_t mask = (uint64_t{1} << bits) - 1;
    return (low_ + mask) & ~mask;
  }
  void normalize() {
    while (range_ < (1u << 24)) {
      range_ <<= 8;
      shift_low();
    }
  }
  // Moves the top byte out; bytes of 0xff wait until it is known whether a carry runs through them. The very first byte can
  // only be zero and is not written.
  void shift_low() {
    if (low_ < 0xff000000u || low_ > 0xffffffffu) {
      const uint8_t carry = static_cast<uint8_t>(low_ >> 32);
      if (!first_) out_.push_back(static_cast<uint8_t>(cache_ + carry));
      first_ = false;
      for (; pending_ > 0; --pending_) out_.push_back(static_cast<uint8_t>(0xff + carry));
      cache_ = static_cast<uint8_t>(low_ >> 24);
    } else {
      ++pending_;
    }
    low_ = (low_ & 0x00ffffffu) << 8;
  }

  std::vector<uint8_t>& out_;
  size_t start_;
  uint64_t low_ = 0;
  uint32_t range_ = 0xffffffffu;
  uint8_t cache_ = 0;
  bool first_ = true;
  uint64_t pending_ = 0;
};

}  // namespace vitrine
