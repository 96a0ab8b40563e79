// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/mip.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace vitrine {
namespace {

// Overlap of the footprint of texel x of floor(n/2) with source texel i, as a share of the footprint.
double overlap(int n, int x, int i) {
  const double m = n > 1 ? n / 2 : 1, low = n * x / m, high = n * (x + 1) / m;
  return std::max(0.0, std::min(high, i + 1.0) - std::max(low, static_cast<double>(i))) / (high - low);
}

TEST(Mip, TapsAreTheFootprintsExactShares) {
  for (int n = 1; n < 70; ++n)
    for (int x = 0; x < mip_size(n); ++x) {
      const MipTaps taps = mip_taps(n, x);
      ASSERT_GE(taps.first, 0);
      ASSERT_LE(taps.first + taps.count, n);
      double sum = 0;
      for (int k = 0; k < taps.count; ++k) {
        sum += static_cast<double>(taps.weight[static_cast<size_t>(k)]);
        ASSERT_NEAR(taps.weight[static_cast<size_t>(k)], overlap(n, x, taps.first + k), 1e-6) << n << ' ' << x;
      }
      ASSERT_NEAR(sum, 1, 1e-6);
    }
}

TEST(Mip, DecimationIsTheMeanUnderEachFootprint) {
  std::mt19937 random(1);
  for (const auto& [w, h] : std::vector<std::pair<int, int>>{{8, 4}, {7, 4}, {8, 5}, {9, 7}, {1, 6}, {5, 1}, {1, 1}, {64, 3}}) {
    std::vector<float> finer(static_cast<size_t>(w * h)), coarser(static_cast<size_t>(mip_size(w) * mip_size(h)));
    for (float& value : finer) value = std::uniform_real_distribution<float>(0, 10)(random);
    decimate(finer.data(), w, h, coarser.data());
    for (int y = 0; y < mip_size(h); ++y)
      for (int x = 0; x < mip_size(w); ++x) {
        double sum = 0;
        for (int j = 0; j < h; ++j)
          for (int i = 0; i < w; ++i)
            sum += overlap(w, x, i) * overlap(h, y, j) * static_cast<double>(finer[static_cast<size_t>(j * w + i)]);
        ASSERT_NEAR(coarser[static_cast<size_t>(y * mip_size(w) + x)], sum, 1e-5) << w << 'x' << h;
      }
  }
}

TEST(Mip, EvenPicturesUseTheVeryFloatsOfTheTaps) {
  std::mt19937 random(2);
  std::vector<float> finer(6 * 4), coarser(3 * 2);
  for (float& value : finer) value = std::uniform_real_distribution<float>(0, 10)(random);
  decimate(finer.data(), 6, 4, coarser.data());
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) {
      const MipTaps tx = mip_taps(6, x), ty = mip_taps(4, y);
      const auto row = [&](int j) {
        return tx.weight[0] * finer[static_cast<size_t>(j * 6 + tx.first)] +
               tx.weight[1] * finer[static_cast<size_t>(j * 6 + tx.first + 1)];
      };
      EXPECT_EQ(coarser[static_cast<size_t>(3 * y + x)], ty.weight[0] * row(ty.first) + ty.weight[1] * row(ty.first + 1));
    }
}

TEST(Mip, ChainsEndAtOneTexel) {
  EXPECT_EQ(mip_level_count(1, 1), 1);
  EXPECT_EQ(mip_level_count(640, 480), 10);
  EXPECT_EQ(mip_level_count(5, 3), 3);
}

}  // namespace
}  // namespace vitrine
