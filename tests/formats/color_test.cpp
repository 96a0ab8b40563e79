// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/color.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace vitrine
