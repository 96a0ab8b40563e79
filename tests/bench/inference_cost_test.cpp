// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/inference_cost.h"

#include <gtest/gtest.h>

#include <string>

namespace vitrine::test {
namespace {

InferenceCostRow row_of(int64_t samples, int width, double seconds) {
  return {samples, width, 3 * width / 4, {.choose_reader = 5, .solve = seconds}, 1000};
}

TEST(InferenceCost, ThePlotShowsBothCurvesWithTheirFiguresAndNotWhatACompilePaysOnce) {
  InferenceCost cost;
  cost.by_samples = {row_of(1, 640, 1.5), row_of(2, 640, 3.25)};
  cost.by_pixels = {row_of(1, 320, 0.75), row_of(1, 640, 1.5)};
  cost.samples_exponent = 1.12;
  cost.pixels_exponent = 0.5;
  const std::string svg = plot_of(cost);
  for (const char* text : {"samples: processor seconds, exponent 1.12", "pixels: processor seconds, exponent 0.50", ">3.25 s<",
                           ">0.75 s<", ">307200<"})
    EXPECT_NE(svg.find(text), std::string::npos) << text << " is not in\n" << svg;
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
}

}  // namespace
}  // namespace vitrine::test
