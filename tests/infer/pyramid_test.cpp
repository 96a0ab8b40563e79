// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/pyramid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/infer/lanes.h"

namespace vitrine {
namespace {

std::vector<float> random_vector(size_t size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> any(-1, 1);
  std::vector<float> v(size);
  for (float& x : v) x = any(random);
  return v;
}
double dot(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  return sum;
}

class PyramidSizes : public ::testing::TestWithParam<std::pair<int, int>> {
 protected:
  Pyramid pyramid{GetParam().first, GetParam().second};
};
INSTANTIATE_TEST_SUITE_P(Sizes, PyramidSizes,
                         ::testing::Values(std::pair{64, 32}, std::pair{24, 40}, std::pair{37, 29}, std::pair{1, 1},
                                           std::pair{8, 1}, std::pair{5, 64}));

TEST_P(PyramidSizes, DecimationAndItsTransposeAreAdjoint) {
  std::vector<float> x = random_vector(pyramid.finest_size(), 1), mx = x;
  mx.resize(pyramid.size());
  pyramid.decimate(mx.data());
  const std::vector<float> y = random_vector(pyramid.size(), 2);
  std::vector<float> mty = y;
  pyramid.decimate_transposed(mty.data());
  mty.resize(pyramid.finest_size());
  EXPECT_NEAR(dot(mx, y), dot(x, mty), 1e-4);
}

TEST_P(PyramidSizes, AConstantStaysConstantAndCostsNothing) {
  std::vector<float> x(pyramid.size(), 0.0f), gradient(pyramid.size());
  std::fill(x.begin(), x.begin() + static_cast<ptrdiff_t>(pyramid.finest_size()), 0.7f);
  pyramid.decimate(x.data());
  for (const float v : x) EXPECT_NEAR(v, 0.7f, 1e-5f);
  pyramid.add_gamma_gradient(x.data(), 1, gradient.data());
  for (const float v : gradient) EXPECT_NEAR(v, 0, 1e-5f);
}

// Gamma is quadratic: its gradient operator G is symmetric, <x, G x> = Gamma(x), and differences of Gamma agree with it.
TEST_P(PyramidSizes, TheGradientOfGammaIsItsDerivative) {
  const std::vector<float> a = random_vector(pyramid.size(), 3), b = random_vector(pyramid.size(), 4);
  std::vector<float> ga(pyramid.size()), gb(pyramid.size());
  pyramid.add_gamma_gradient(a.data(), 1, ga.data());
  pyramid.add_gamma_gradient(b.data(), 1, gb.data());
  EXPECT_NEAR(dot(a, gb), dot(b, ga), 1e-3);
  double gamma = 0;
  for (size_t l = 0; l + 1 < pyramid.levels().size(); ++l) {
    const Pyramid::Level& level = pyramid.levels()[l];
    for (int y = 0; y < level.height; ++y)
      for (int x = 0; x < level.width; ++x)
        gamma += std::pow(static_cast<double>(a[level.offset + static_cast<size_t>(y * level.width + x)] -
                                              pyramid.interpolate(a.data(), l, x, y)),
                          2);
  }
  EXPECT_NEAR(dot(a, ga), gamma, 1e-3 * (1 + gamma));
}

TEST_P(PyramidSizes, LanesGiveTheBitsThatSingleNumbersGive) {
  const std::vector<float> x = random_vector(pyramid.size(), 5);
  std::vector<Lanes<3>> lanes(pyramid.size()), gradient(pyramid.size());
  for (size_t i = 0; i < x.size(); ++i)
    for (size_t c = 0; c < 12; ++c) lanes[i].set(c, static_cast<float>(c + 1) * x[i]);
  std::vector<float> single(pyramid.size());
  for (size_t i = 0; i < x.size(); ++i) single[i] = 7 * x[i];
  std::vector<float> single_gradient(pyramid.size());
  pyramid.decimate(lanes.data());
  pyramid.decimate(single.data());
  pyramid.add_gamma_gradient(lanes.data(), 0.3f, gradient.data());
  pyramid.add_gamma_gradient(single.data(), 0.3f, single_gradient.data());
  for (size_t i = 0; i < x.size(); ++i) ASSERT_EQ(gradient[i][6], single_gradient[i]) << i;
}

}  // namespace
}  // namespace vitrine
