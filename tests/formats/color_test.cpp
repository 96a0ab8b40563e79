// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/color.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vitrine {
namespace {

TEST(Color, TheTransformLosesNothing) {
  for (int r = 0; r <= 4095; r += 91)
    for (int g = 0; g <= 4095; g += 65)
      for (int b = 0; b <= 4095; b += 7) {
        const RgbCode back = rgb_from_ycocg(ycocg_from_rgb({r, g, b}));
        ASSERT_TRUE(back.r == r && back.g == g && back.b == b) << r << " " << g << " " << b;
      }
}

TEST(Color, GreyHasNoChromaAndTheRangesAreThoseOfTheSpecification) {
  for (int v = 0; v <= 4095; ++v) {
    const Ycocg grey = ycocg_from_rgb({v, v, v});
    ASSERT_TRUE(grey.y == v && grey.co == 0 && grey.cg == 0);
  }
  for (const int r : {0, 4095})
    for (const int g : {0, 4095})
      for (const int b : {0, 4095}) {
        const Ycocg c = ycocg_from_rgb({r, g, b});
        EXPECT_TRUE(c.y >= 0 && c.y <= 4095 && c.co >= -4095 && c.co <= 4095 && c.cg >= -4095 && c.cg <= 4095);
      }
}

TEST(Color, EveryByteOfAnSrgbTextureIsTheSameByteAgainOnADisplay) {
  for (int byte = 0; byte < 256; ++byte) {
    EXPECT_EQ(std::lround(255 * srgb_from_linear(linear_from_srgb(byte / 255.0))), byte);
    EXPECT_EQ(std::lround(255 * srgb_from_linear(linear_from_srgb(static_cast<float>(byte) / 255))), byte);
  }
  // A good fifth of the light is half of the codes.
  EXPECT_NEAR(srgb_from_linear(0.2140411), 0.5, 1e-6);
  EXPECT_EQ(srgb_from_linear(0.0), 0);
  EXPECT_NEAR(srgb_from_linear(1.0), 1, 1e-12);
}

TEST(Color, NoiseIsWeighedByTheSlopeOfTheCurveThatDisplaysShow) {
  constexpr double kStep = 1e-7;
  for (const double light : {0.0, 0.001, 0.003, 0.004, 0.02, 0.2, 0.9})
    EXPECT_NEAR(srgb_slope(light) * kStep, srgb_from_linear(light + kStep) - srgb_from_linear(light), 1e-4 * kStep) << light;
}

}  // namespace
}  // namespace vitrine
