// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/companding.h"

#include <gtest/gtest.h>
#include <xxhash.h>

#include <bit>
#include <cmath>
#include <limits>

namespace vitrine {
namespace {

TEST(Companding, CodesSurviveTheWayToRadianceAndBack) {
  for (int code = 0; code <= kCodeMax; ++code) ASSERT_EQ(code_from_radiance(radiance_from_code(code)), code);
}

TEST(Companding, WhiteIsWhiteAndTheRangeReachesTwentyOneTimesFurther) {
  EXPECT_EQ(radiance_from_code(0), 0.0f);
  EXPECT_EQ(radiance_from_code(kCodeWhite), 1.0f);
  EXPECT_NEAR(radiance_from_code(kCodeMax), std::pow(4095.0 / 1023.0, 2.2), 1e-4);
  EXPECT_EQ(half_from_code()[0], 0);
  EXPECT_EQ(half_from_code()[kCodeWhite], 0x3c00);
}

TEST(Companding, RadianceIsRoundedToTheNearestCode) {
  for (int i = 1; i <= 20000; ++i) {
    const float radiance = 22.0f * static_cast<float>(i) / 20000;
    const double exact = std::min<double>(kCodeMax, kCodeWhite * std::pow(static_cast<double>(radiance), 1 / 2.2));
    ASSERT_LE(std::abs(code_from_radiance(radiance) - exact), 0.5 + 1e-9) << radiance;
  }
}

TEST(Companding, WhatIsNotARadianceBecomesTheNearestEnd) {
  EXPECT_EQ(code_from_radiance(std::numeric_limits<float>::quiet_NaN()), 0);
  EXPECT_EQ(code_from_radiance(-1), 0);
  EXPECT_EQ(code_from_radiance(-0.0f), 0);
  EXPECT_EQ(code_from_radiance(std::numeric_limits<float>::infinity()), kCodeMax);
  EXPECT_EQ(code_from_radiance(std::numeric_limits<float>::max()), kCodeMax);
  EXPECT_EQ(radiance_from_code(-5), radiance_from_code(0));
  EXPECT_EQ(radiance_from_code(100000), radiance_from_code(kCodeMax));
}

TEST(Companding, BrighterIsNeverDarker) {
  for (int code = 1; code <= kCodeMax; ++code) {
    ASSERT_LT(radiance_from_code(code - 1), radiance_from_code(code));
    ASSERT_LE(half_from_code()[static_cast<size_t>(code - 1)], half_from_code()[static_cast<size_t>(code)]);
  }
}

// Against 64-bit (x86: 80-bit) floating point: the table's half is the nearest one wherever that can tell.
TEST(Companding, TheTargetsTableIsCorrectlyRounded) {
  for (int code = 0; code <= kCodeMax; ++code) {
    const uint16_t half = half_from_code()[static_cast<size_t>(code)];
    const long double exact = std::pow(static_cast<long double>(code) / kCodeWhite, 2.2L);
    const auto distance = [&](uint16_t h) { return std::fabs(static_cast<long double>(float_from_half(h)) - exact); };
    ASSERT_LE(distance(half), distance(static_cast<uint16_t>(half + 1)) * (1 + 1e-9L)) << code;
    if (half > 0) {
      ASSERT_LE(distance(half), distance(static_cast<uint16_t>(half - 1)) * (1 + 1e-9L)) << code;
    }
  }
}

// The same table on every machine: part of the format (SPEC.md, "Companding").
TEST(Companding, TheTargetsTableIsTheOneOfTheSpecification) {
  std::array<uint8_t, 2 * (kCodeMax + 1)> bytes;
  for (size_t i = 0; i <= kCodeMax; ++i) {
    bytes[2 * i] = static_cast<uint8_t>(half_from_code()[i] & 0xff);
    bytes[2 * i + 1] = static_cast<uint8_t>(half_from_code()[i] >> 8);
  }
  EXPECT_EQ(XXH3_64bits(bytes.data(), bytes.size()), 0x5478d3398168b18eu);
}

// ---- halves ----

// The value by its definition (IEEE 754-2019, 3.4).
double value_of(uint16_t half) {
  const int exponent = half >> 10 & 31, mantissa = half & 1023;
  const double magnitude = exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
  return half & 0x8000 ? -magnitude : magnitude;
}
bool is_nan(uint16_t half) { return (half & 0x7fff) > 0x7c00; }

TEST(Half, All65536ValuesAreConvertedExactlyAndBack) {
  for (uint32_t h = 0; h < 65536; ++h) {
    const uint16_t half = static_cast<uint16_t>(h);
    const float value = float_from_half(half);
    if (is_nan(half)) {
      ASSERT_TRUE(std::isnan(value));
      ASSERT_TRUE(is_nan(half_from_float(value)));
      continue;
    }
    if ((half & 0x7fff) == 0x7c00)
      ASSERT_TRUE(std::isinf(value));
    else
      ASSERT_EQ(static_cast<double>(value), value_of(half)) << h;
    ASSERT_EQ(std::signbit(value), (half & 0x8000) != 0);
    ASSERT_EQ(half_from_float(value), half) << h;
  }
}

TEST(Half, BetweenTwoHalvesTheNearerAndOfTwoTheEvenIsTaken) {
  for (uint32_t h = 0; h < 0x7bff; ++h) {
    const uint16_t low = static_cast<uint16_t>(h), high = static_cast<uint16_t>(h + 1);
    const float middle = static_cast<float>((value_of(low) + value_of(high)) / 2);
    ASSERT_EQ(half_from_float(middle), h % 2 == 0 ? low : high) << h;
    ASSERT_EQ(half_from_float(std::nextafter(middle, 0.0f)), low) << h;
    ASSERT_EQ(half_from_float(std::nextafter(middle, 1e9f)), high) << h;
    ASSERT_EQ(half_from_float(-std::nextafter(middle, 1e9f)), high | 0x8000) << h;
  }
}

TEST(Half, BeyondTheLargestIsInfinity) {
  EXPECT_EQ(half_from_float(65504.0f), 0x7bff);
  EXPECT_EQ(half_from_float(65519.99f), 0x7bff);
  EXPECT_EQ(half_from_float(65520.0f), 0x7c00);
  EXPECT_EQ(half_from_float(-1e30f), 0xfc00);
  EXPECT_EQ(half_from_float(std::numeric_limits<float>::infinity()), 0x7c00);
  EXPECT_EQ(half_from_float(std::numeric_limits<float>::denorm_min()), 0);
}

}  // namespace
}  // namespace vitrine
