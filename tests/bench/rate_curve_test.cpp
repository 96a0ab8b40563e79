// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/rate_curve.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vitrine::test {
namespace {

// A coder whose bytes halve every 5 steps and whose error doubles every 4.
struct Coder {
  int codings = 0, measurements = 0;
  RateCurve curve(double best, double worst, bool whole_steps) {
    return {{best, worst, whole_steps, 6},
            [this](double q) { return ++codings, 1e6 * std::exp2(-q / 5); },
            [this](double q) { return ++measurements, std::exp2(q / 4); }};
  }
};

double quality_of(double bytes) { return 5 * std::log2(1e6 / bytes); }

TEST(RateCurve, a_wanted_size_is_met_within_a_percent_in_few_codings) {
  Coder coder;
  RateCurve curve = coder.curve(1, 51, false);
  const Rated rated = curve.at(20000, 40);
  EXPECT_NEAR(rated.bytes, 20000, 200);
  EXPECT_NEAR(std::log2(rated.squared_error), quality_of(rated.bytes) / 4, 1e-9);
  EXPECT_LE(coder.codings, 5);
  EXPECT_EQ(coder.measurements, 1);  // which may be costly
}

TEST(RateCurve, between_coarse_steps_quality_is_interpolated_at_exactly_the_wanted_size) {
  Coder coder;
  RateCurve curve = coder.curve(1, 63, true);
  const double bytes = 1e6 * std::exp2(-30.4 / 5);
  const Rated rated = curve.at(bytes, 40);
  EXPECT_DOUBLE_EQ(rated.bytes, bytes);
  EXPECT_NEAR(std::log2(rated.squared_error), 30.4 / 4, 1e-9);
  EXPECT_EQ(rated.quality, 30);
}

TEST(RateCurve, a_coder_that_cannot_become_so_small_says_how_small_it_is) {
  Coder coder;
  RateCurve curve = coder.curve(1, 31, true);
  const Rated rated = curve.at(1000, 10);
  EXPECT_DOUBLE_EQ(rated.bytes, 1e6 * std::exp2(-31.0 / 5));
  EXPECT_EQ(rated.quality, 31);
}

TEST(RateCurve, what_was_coded_for_one_size_serves_the_next) {
  Coder coder;
  RateCurve curve = coder.curve(1, 51, false);
  curve.at(20000, 40);
  const int codings = coder.codings;
  curve.at(20000, 10);
  EXPECT_EQ(coder.codings, codings);
}

}  // namespace
}  // namespace vitrine::test
