// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/solver.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>

#include "host/infer/normal_matrix.h"
#include "host/infer/range_penalty.h"

namespace vitrine {
namespace {

constexpr int kSupersampling = 2, kWidth = 40, kHeight = 30;

// A view of a texture: turned, magnified and shifted by `view`, with a corner that something hides; between the two finest
// levels.
ObjectMatrix make_view(const Pyramid& pyramid, int view) {
  ObjectMatrix matrix{{3, 2, kWidth, kHeight}, {}, {0}, {}};
  const float angle = 0.3f * static_cast<float>(view), scale = 0.5f + 0.1f * static_cast<float>(view % 3);
  const float mix = 0.2f * static_cast<float>(view % 4);  // of the second level
  for (int y = 0; y < kHeight * kSupersampling; ++y)
    for (int x = 0; x < kWidth * kSupersampling; ++x) {
      if (x + y < 20 + view) continue;
      const float a = scale * (static_cast<float>(x) / (kWidth * kSupersampling) - 0.5f),
                  b = scale * (static_cast<float>(y) / (kHeight * kSupersampling) - 0.5f);
      const float u = 0.5f + a * std::cos(angle) - b * std::sin(angle), v = 0.5f + a * std::sin(angle) + b * std::cos(angle);
      matrix.samples.push_back(static_cast<uint32_t>(y * kWidth * kSupersampling + x));
      for (const size_t l : {0, 1}) {
        const Pyramid::Level& level = pyramid.levels()[l];
        const float s = u * static_cast<float>(level.width) - 0.5f, t = v * static_cast<float>(level.height) - 0.5f;
        const int i = static_cast<int>(s), j = static_cast<int>(t);
        const float fs = s - static_cast<float>(i), ft = t - static_cast<float>(j), share = l ? mix : 1 - mix;
        for (int k = 0; k < 4 && share > 0; ++k)
          matrix.entries.push_back(
              {static_cast<uint32_t>(level.offset) + static_cast<uint32_t>((j + k / 2) * level.width + i + k % 2),
               share * (k % 2 ? fs : 1 - fs) * (k / 2 ? ft : 1 - ft)});
      }
      matrix.starts.push_back(static_cast<uint32_t>(matrix.entries.size()));
    }
  return matrix;
}

struct View {
  ObjectMatrix matrix;
  FilteredMatrix filtered;
  Observation observation;
  std::vector<std::vector<glm::vec3>> layers;  // per texture
};

std::unique_ptr<View> view_of(const Pyramid& pyramid, int number, size_t textures, float brightest) {
  auto view = std::make_unique<View>();
  view->matrix = make_view(pyramid, number);
  view->filtered = FilteredMatrix(view->matrix, kSupersampling, 2 * kWidth, 2 * kHeight);
  Observation& o = view->observation;
  o.matrix = &view->filtered;
  o.weight = view->filtered.coverage();
  for (size_t p = 0; p < o.weight.size(); ++p) {
    o.scale.push_back(o.weight[p] > 0 ? std::pow(o.weight[p] / view->filtered.filtered()[p], 2.0f) : 0);
    o.rows += o.weight[p] > 0;
  }
  for (size_t t = 0; t < textures; ++t) {
    view->layers.emplace_back();
    for (size_t p = 0; p < o.weight.size(); ++p) {
      const float wave = std::sin(0.37f * static_cast<float>(p % kWidth) + static_cast<float>(t)) *
                         std::cos(0.29f * static_cast<float>(p / kWidth));
      view->layers.back().push_back(brightest * (0.5f + glm::vec3(0.5f, 0.3f, -0.4f) * wave));
    }
  }
  return view;
}

class SolverTest : public ::testing::Test {
 protected:
  static constexpr int kViews = 5;
  void make(size_t textures, float brightest = 1) {
    for (int v = 0; v < kViews; ++v) {
      views.push_back(view_of(pyramid, v, textures, brightest));
      observed.add(views.back()->observation);
      normal.add(views.back()->observation);
    }
    normal.finish();
  }
  std::vector<std::vector<glm::vec3>> solve(const DataTerm& data, const SolverOptions& options = {}) const {
    TextureSolver solver(pyramid, views[0]->layers.size(), options);
    for (const auto& view : views) solver.add(view->observation, view->layers);
    return solver.solve(data);
  }
  Pyramid pyramid{37, 26};  // odd sizes: blocks with texels that are not there
  std::vector<std::unique_ptr<View>> views;
  ObservedTerm observed{pyramid.size()};
  NormalMatrix normal{pyramid};
};

template <typename T>
std::vector<T> random_texels(size_t size) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> any(-1, 1);
  std::vector<T> texels(size);
  for (T& texel : texels)
    for (size_t c = 0; c < T::kChannels; ++c) texel.set(c, any(random));
  return texels;
}

template <typename T>
void expect_equal_products(const Pyramid& pyramid, const DataTerm& a, const DataTerm& b) {
  const auto x = random_texels<T>(pyramid.size());
  std::vector<T> by_a(pyramid.size()), by_b(pyramid.size());
  a.add_product(x.data(), by_a.data());
  b.add_product(x.data(), by_b.data());
  for (size_t i = 0; i < x.size(); ++i)
    for (size_t c = 0; c < T::kChannels; ++c) ASSERT_NEAR(by_a[i][c], by_b[i][c], 2e-4f) << "texel " << i << ", channel " << c;
}

TEST_F(SolverTest, MatricesSummedUpMultiplyAsTheyDoOneByOne) {
  make(1);
  expect_equal_products<Lanes<1>>(pyramid, observed, normal);
  expect_equal_products<Lanes<2>>(pyramid, observed, normal);
  expect_equal_products<Lanes<3>>(pyramid, observed, normal);
}

TEST_F(SolverTest, TexturesAreTheSameInBothForms) {
  make(2);
  const auto a = solve(observed), b = solve(normal);
  for (size_t t = 0; t < a.size(); ++t)
    for (size_t i = 0; i < a[t].size(); ++i)
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(a[t][i][k], b[t][i][k], 1e-3f) << "texture " << t << ", texel " << i;
}

TEST_F(SolverTest, SummedMatricesAreTheSameBytesOnOneThreadAndOnFour) {
  const auto run = [&](size_t threads) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    NormalMatrix matrix(pyramid);
    for (const auto& view : views) matrix.add(view->observation);
    matrix.finish();
    const auto x = random_texels<Lanes<1>>(pyramid.size());
    std::vector<Lanes<1>> product(pyramid.size());
    matrix.add_product(x.data(), product.data());
    return product;
  };
  make(1);
  const auto one = run(1), four = run(4);
  EXPECT_EQ(std::memcmp(one.data(), four.data(), one.size() * sizeof one[0]), 0);
}

TEST_F(SolverTest, WhatMatricesSummedUpTakeDoesNotGrowWithTheSameViewAgain) {
  make(1);
  const size_t blocks = normal.block_count();
  NormalMatrix twice(pyramid);
  for (int round = 0; round < 2; ++round)
    for (const auto& view : views) twice.add(view->observation);
  twice.finish();
  EXPECT_EQ(twice.block_count(), blocks);
}

TEST_F(SolverTest, ATextureComesOutTheSameWhicheverOthersAreSolvedBesideIt) {
  make(4);
  const auto together = solve(normal);
  for (auto& view : views) view->layers = {view->layers[2]};
  const auto alone = solve(normal);
  EXPECT_TRUE(together[2] == alone[0]);
}

TEST(RangePenaltyTest, ItsDerivativesAreThoseOfFiniteDifferences) {
  for (const double x : {-0.001, 0.0, 0.003, 0.25, 0.5, 0.9, 1.0, 1.0015}) {
    const double h = 1e-7;
    const RangePenalty at = range_penalty(x), above = range_penalty(x + h), below = range_penalty(x - h);
    EXPECT_NEAR((above.value - below.value) / (2 * h), at.slope, 1e-5 * (1 + std::fabs(at.slope))) << x;
    EXPECT_NEAR((above.slope - below.slope) / (2 * h), at.curvature, 1e-5 * (1 + at.curvature)) << x;
  }
}

TEST(RangePenaltyTest, ItsCalibrationMakesTheEndsOfTheRangeCostOneMoreThanTheMiddle) {
  EXPECT_NEAR(range_calibration() * (range_penalty(0).value - range_penalty(0.5).value), 1, 1e-12);
  EXPECT_NEAR(range_penalty(0).value, range_penalty(1).value, 1e-9);
}

// Light beyond white is asked for: without the penalty textures follow it.
TEST_F(SolverTest, TexelsStayInTheRangeThatIsAskedFor) {
  constexpr float kWhite = 2;
  make(2, 1.3f * kWhite);
  const auto largest = [](const std::vector<std::vector<glm::vec3>>& textures) {
    float value = 0;
    for (const auto& texture : textures)
      for (const glm::vec3& texel : texture) value = std::max({value, texel.x, texel.y, texel.z});
    return value;
  };
  const auto free = solve(normal), kept = solve(normal, {.range_regularization = 1.0f / 32, .white = kWhite});
  EXPECT_GT(largest(free), 1.1f * kWhite);
  EXPECT_LT(largest(kept), (1 + static_cast<float>(kRangeMargin)) * kWhite);
  EXPECT_GT(largest(kept), 0.9f * kWhite);
}

TEST_F(SolverTest, RangeRegularizationLeavesTexturesWithinTheRangeAboutAsTheyAre) {
  make(1, 0.8f);
  const auto free = solve(normal), kept = solve(normal, {.range_regularization = 1.0f / 1024});
  double difference = 0;
  for (size_t i = 0; i < free[0].size(); ++i)
    difference += static_cast<double>(glm::dot(free[0][i] - kept[0][i], free[0][i] - kept[0][i]));
  EXPECT_LT(std::sqrt(difference / (3 * static_cast<double>(free[0].size()))), 0.02);
}

}  // namespace
}  // namespace vitrine
