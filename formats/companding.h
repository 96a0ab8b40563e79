// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The curve between linear light and the integers that are coded (Hakura 2001, section 4.6: code the gamma-corrected
// signal, so that errors in the dark are not magnified; sum and filter in linear light).
//
//   code = round(kCodeWhite * L^(1/2.2)),  L = kExposureWhite * radiance,  clamped to [0, kCodeMax]
//
// Radiance 1 is display white at exposure 1; codes reach to about 21 times white, so highlights survive to the target.
#pragma once

#include <array>
#include <cstdint>

namespace vitrine {

inline constexpr int kCodeWhite = 1023;
inline constexpr int kCodeMax = 4095;

// Radiance (>= 0; NaN and negative count as 0) to code in [0, kCodeMax]. Host side: uses pow.
int code_from_radiance(float radiance);
// Code to radiance, for code in [0, kCodeMax] (clamped).
float radiance_from_code(int code);
// The table the target uses: IEEE half floats of radiance_from_code for every code. Bit-identical on every machine (it is
// computed with integer and correctly rounded operations only).
const std::array<uint16_t, kCodeMax + 1>& half_from_code();

// IEEE binary16 <-> binary32, round to nearest even.
uint16_t half_from_float(float value);
float float_from_half(uint16_t half);

}  // namespace vitrine
