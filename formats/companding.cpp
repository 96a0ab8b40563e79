// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/companding.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "formats/wide_integer.h"

namespace vitrine {
namespace {

constexpr double kGamma = 2.2;

// half_from_code rounds (code / kCodeWhite)^(11/5) correctly with integers alone: the value lies above a half's upper
// rounding boundary m * 2^-25 (m an integer) exactly when
//
//   (code / kCodeWhite)^11 > (m * 2^-25)^5   <=>   code^11 * 2^125 > m^5 * kCodeWhite^11
//
// which whole numbers of at most 264 bits decide. A tie would make the ratio's 11th power a dyadic fraction; as kCodeWhite is
// odd the ratio would be whole, and of 0, 1, 2, 3, 4 only 0 and 1 have rational fifth roots of it: both are halves themselves.
constexpr int kBoundaryBits = 25;

using Wide = WideInteger<12>;

Wide power(uint32_t base, int exponent) {
  Wide result(1);
  for (int i = 0; i < exponent; ++i) result.multiply(base);
  return result;
}

// The value of a positive finite half in units of 2^-24, the smallest subnormal.
uint32_t units_of_half(uint16_t half) {
  const uint32_t exponent = half >> 10, mantissa = half & 0x3ffu;
  return exponent == 0 ? mantissa : (mantissa | 0x400u) << (exponent - 1);
}

// kCodeWhite^11 times the fifth power of the boundary between `half` and its successor, in units of 2^-25.
Wide boundary_above(uint16_t half) {
  Wide boundary = power(units_of_half(half) + units_of_half(static_cast<uint16_t>(half + 1)), 5);
  for (int i = 0; i < 11; ++i) boundary.multiply(kCodeWhite);
  return boundary;
}

// Codes and halves both ascend, so one walk over the halves serves all codes.
std::array<uint16_t, kCodeMax + 1> make_half_from_code() {
  std::array<uint16_t, kCodeMax + 1> table{};
  uint16_t half = 0;
  Wide boundary = boundary_above(half);
  for (int code = 0; code <= kCodeMax; ++code) {
    Wide value = power(static_cast<uint32_t>(code), 11);
    value.shift_left(5 * kBoundaryBits);
    while (boundary < value) boundary = boundary_above(++half);
    table[static_cast<size_t>(code)] = half;
  }
  return table;
}

std::array<float, kCodeMax + 1> make_radiance_from_code() {
  std::array<float, kCodeMax + 1> table{};
  for (int code = 0; code <= kCodeMax; ++code)
    table[static_cast<size_t>(code)] = static_cast<float>(std::pow(static_cast<double>(code) / kCodeWhite, kGamma));
  return table;
}

// `value` >> `shift`, rounded to nearest even.
uint32_t shift_rounded(uint32_t value, int shift) {
  const uint32_t half = 1u << (shift - 1), rest = value & ((half << 1) - 1), whole = value >> shift;
  return whole + (rest > half || (rest == half && (whole & 1u)) ? 1u : 0u);
}

}  // namespace

int code_from_radiance(float radiance) {
  if (!(radiance > 0)) return 0;  // also NaN
  const double code = kCodeWhite * std::pow(static_cast<double>(radiance), 1 / kGamma);
  return code >= kCodeMax ? kCodeMax : static_cast<int>(code + 0.5);
}

float radiance_from_code(int code) {
  static const std::array<float, kCodeMax + 1> table = make_radiance_from_code();
  return table[static_cast<size_t>(std::clamp(code, 0, kCodeMax))];
}

const std::array<uint16_t, kCodeMax + 1>& half_from_code() {
  static const std::array<uint16_t, kCodeMax + 1> table = make_half_from_code();
  return table;
}

uint16_t half_from_float(float value) {
  const uint32_t bits = std::bit_cast<uint32_t>(value), magnitude = bits & 0x7fffffffu;
  const uint16_t sign = static_cast<uint16_t>(bits >> 16 & 0x8000u);
  if (magnitude > 0x7f800000u) return static_cast<uint16_t>(sign | 0x7e00u | (magnitude >> 13 & 0x3ffu));  // NaN, quiet
  if (magnitude >= 0x477ff000u) return static_cast<uint16_t>(sign | 0x7c00u);  // 65520 and above round to infinity
  if (magnitude < 0x38800000u) {                                               // below 2^-14: subnormal, in units of 2^-24
    const int exponent = static_cast<int>(magnitude >> 23);
    const int shift = 126 - exponent;
    if (shift > 25) return sign;
    return static_cast<uint16_t>(sign | shift_rounded((magnitude & 0x7fffffu) | 0x800000u, shift));
  }
  return static_cast<uint16_t>(sign | (shift_rounded(magnitude, 13) - (112u << 10)));
}

float float_from_half(uint16_t half) {
  const uint32_t sign = static_cast<uint32_t>(half & 0x8000u) << 16, exponent = half >> 10 & 0x1fu, mantissa = half & 0x3ffu;
  if (exponent == 31) return std::bit_cast<float>(sign | 0x7f800000u | mantissa << 13);
  if (exponent != 0) return std::bit_cast<float>(sign | (exponent + 112) << 23 | mantissa << 13);
  const float magnitude = static_cast<float>(mantissa) * 0x1p-24f;
  return sign ? -magnitude : magnitude;
}

}  // namespace vitrine
