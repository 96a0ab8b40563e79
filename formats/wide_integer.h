// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Non-negative whole numbers of a fixed number of 32-bit limbs: just enough to compare powers exactly (companding.cpp).
#pragma once

#include <array>
#include <cstdint>

namespace vitrine {

template <int kLimbs>
class WideInteger {
 public:
  explicit WideInteger(uint32_t value) { limbs_[0] = value; }

  // Overflow is the caller's bug; sizes are chosen so that it cannot happen.
  void multiply(uint32_t factor) {
    uint64_t carry = 0;
    for (uint32_t& limb : limbs_) {
      carry += static_cast<uint64_t>(limb) * factor;
      limb = static_cast<uint32_t>(carry);
      carry >>= 32;
    }
  }
  void shift_left(int bits) {
    for (; bits >= 31; bits -= 31) multiply(1u << 31);
    multiply(1u << bits);
  }
  friend bool operator<(const WideInteger& a, const WideInteger& b) {
    for (int i = kLimbs - 1; i >= 0; --i)
      if (a.limbs_[i] != b.limbs_[i]) return a.limbs_[i] < b.limbs_[i];
    return false;
  }

 private:
  std::array<uint32_t, kLimbs> limbs_{};  // least significant first
};

}  // namespace vitrine
