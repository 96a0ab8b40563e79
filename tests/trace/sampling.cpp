// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Every sampler draws from the density that it states: chi-square tests, as in pbrt-v4's bsdfs_test.
#include <gtest/gtest.h>

#include <random>

#include "formats/pixel_filter.h"
#include "host/trace/alias_table.h"
#include "host/trace/bsdf.h"
#include "host/trace/environment_light.h"
#include "host/trace/filter_sampler.h"
#include "host/trace/sampler.h"
#include "tests/trace/measure.h"

namespace vitrine::trace {
namespace {

using test::goodness_of_fit;

// Bins over the sphere: equal steps of z and of the angle about it.
constexpr int kRows = 32, kColumns = 48;
int bin_of(const glm::vec3& w) {
  const int row = std::clamp(static_cast<int>((w.z + 1) / 2 * kRows), 0, kRows - 1);
  const float phi = std::atan2(w.y, w.x) / (2 * kPi) + 0.5f;
  return row * kColumns + std::clamp(static_cast<int>(phi * kColumns), 0, kColumns - 1);
}

constexpr double kLeastChance = 0.01;
constexpr uint32_t kSeeds = 3;

// Of the least of several independent chances (Sidak 1967).
double corrected(double least_chance) { return 1 - std::pow(1 - least_chance, kSeeds); }

// Compares histograms of `draw` with the integral of `density`, which with the share of failed draws must make one.
void expect_density(const std::function<bool(std::mt19937&, glm::vec3&)>& draw,
                    const std::function<double(const glm::vec3&)>& density, int fine = 12) {  // `fine`: points per bin and axis
  constexpr int kDraws = 200000;
  std::vector<double> shares(kRows * kColumns + 1);
  double total = 0;
  for (int row = 0; row < kRows * fine; ++row) {
    const double z = 2 * (row + 0.5) / (kRows * fine) - 1, s = std::sqrt(1 - z * z);
    for (int column = 0; column < kColumns * fine; ++column) {
      const double phi = 2 * kPi * ((column + 0.5) / (kColumns * fine) - 0.5);
      const glm::vec3 w(s * std::cos(phi), s * std::sin(phi), z);
      const double p = density(w) * 4 * kPi / (kRows * fine * kColumns * fine);
      shares[static_cast<size_t>(row / fine * kColumns + column / fine)] += p;
      total += p;
    }
  }
  shares.back() = std::max(1 - total, 0.0);
  std::vector<double> expected;
  for (const double share : shares) expected.push_back(share * kDraws);
  double least_chance = 1;
  for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
    std::mt19937 random(seed);
    std::vector<double> counts(shares.size());
    for (int i = 0; i < kDraws; ++i) {
      glm::vec3 w;
      ++counts[draw(random, w) ? static_cast<size_t>(bin_of(w)) : counts.size() - 1];
    }
    EXPECT_NEAR(total + counts.back() / kDraws, 1, 0.005) << "density and failed draws do not make one";
    least_chance = std::min(least_chance, goodness_of_fit(counts, expected));
  }
  EXPECT_GT(corrected(least_chance), kLeastChance);
}

float uniform(std::mt19937& random) { return static_cast<float>(random() >> 8) * 0x1p-24f; }

void expect_lobes_fit(const SurfaceParameters& p, const glm::vec3& wo) {
  const glm::vec3 n(0, 0, 1);
  const Bsdf bsdf(p, wo, n, n, n);
  if (bsdf.has_diffuse()) {
    expect_density(
        [&](std::mt19937& random, glm::vec3& w) {
          BsdfSample s;
          const glm::vec2 u(uniform(random), uniform(random));
          const bool good = bsdf.sample_diffuse(u, s);
          w = s.wi;
          return good;
        },
        [&](const glm::vec3& w) { return bsdf.evaluate(w).diffuse_pdf; });
  }
  if (bsdf.has_specular()) {
    expect_density(
        [&](std::mt19937& random, glm::vec3& w) {
          BsdfSample s;
          const glm::vec2 u(uniform(random), uniform(random));
          const bool good = bsdf.sample_specular(uniform(random), u, s);
          w = s.wi;
          return good;
        },
        [&](const glm::vec3& w) { return bsdf.evaluate(w).specular_pdf; });
  }
}

const glm::vec3 kViews[] = {glm::normalize(glm::vec3(0.3f, 0.1f, 1)), glm::normalize(glm::vec3(-1, 0.5f, 0.5f))};

TEST(BsdfSampling, DiffuseAndSpecularFollowTheirDensities) {
  for (const float alpha : {0.15f, 0.5f, 1.0f}) {
    SurfaceParameters p;
    p.alpha = alpha;
    p.diffuse = glm::vec3(0.5f);
    p.dielectric = 1;
    p.dielectric_f0 = glm::vec3(0.04f);
    p.dielectric_f90 = glm::vec3(1);
    for (const glm::vec3& wo : kViews) expect_lobes_fit(p, wo);
  }
}

TEST(BsdfSampling, MetalFollowsItsDensity) {
  SurfaceParameters p;
  p.alpha = 0.8f;
  p.metal = 1;
  p.metal_f0 = {1, 0.8f, 0.4f};
  for (const glm::vec3& wo : kViews) expect_lobes_fit(p, wo);
}

TEST(BsdfSampling, CoatFollowsItsDensity) {
  SurfaceParameters p;
  p.alpha = 0.6f;
  p.metal = 1;
  p.metal_f0 = glm::vec3(0.5f);
  p.coat = 1;
  p.coat_alpha = 0.2f;
  for (const glm::vec3& wo : kViews) expect_lobes_fit(p, wo);
}

TEST(BsdfSampling, RoughGlassFollowsItsDensityFromBothSides) {
  const GlassAlbedo albedo(1.5f);
  for (const bool thin : {false, true}) {
    for (const float side : {1.0f, -1.0f}) {
      SurfaceParameters p;
      p.alpha = 0.3f;
      p.glass = 1;
      p.thin = thin;
      p.glass_albedo = &albedo;
      for (const glm::vec3& wo : kViews) expect_lobes_fit(p, {wo.x, wo.y, side * wo.z});
    }
  }
}

TEST(EnvironmentSampling, FollowsItsDensity) {
  Environment e;
  e.width = 32;
  e.height = 16;
  e.rotation = 0.7f;
  for (int i = 0; i < 32 * 16; ++i) e.radiance.push_back(glm::vec3(static_cast<float>((i * 7919) % 13)));
  const EnvironmentLight light(e);
  expect_density(
      [&](std::mt19937& random, glm::vec3& w) {
        float pdf;
        const float pick = uniform(random);
        const glm::vec2 u(uniform(random), uniform(random));
        w = light.sample(pick, u, pdf);
        return pdf > 0;
      },
      [&](const glm::vec3& w) { return light.pdf(w); }, 40);  // finer: the density has steps
}

TEST(EnvironmentSampling, StatedDensityIsThatOfTheDirection) {
  Environment e;
  e.width = 32;
  e.height = 16;
  for (int i = 0; i < 32 * 16; ++i) e.radiance.push_back(glm::vec3(static_cast<float>(i % 5)));
  const EnvironmentLight light(e);
  std::mt19937 random(3);
  int differ = 0;
  for (int i = 0; i < 2000; ++i) {
    float pdf;
    const float pick = uniform(random);
    const glm::vec2 u(uniform(random), uniform(random));
    const glm::vec3 w = light.sample(pick, u, pdf);
    differ += std::fabs(pdf - light.pdf(w)) > 1e-3f * pdf;
  }
  EXPECT_LT(differ, 20);  // directions within rounding of a cell's border may count to the next cell
}

TEST(FilterSampling, OffsetsAreDistributedAsThePixelFilter) {
  const FilterSampler filter;
  constexpr int kBins = 40, kDraws = 200000;
  std::vector<double> counts(kBins), expected(kBins);
  double total = 0;
  for (int i = 0; i < 100 * kBins; ++i) {
    const double w = pixel_filter(static_cast<float>(2 * (i + 0.5) / (100 * kBins) - 1));
    expected[static_cast<size_t>(i / 100)] += w;
    total += w;
  }
  for (double& e : expected) e *= kDraws / total;
  std::mt19937 random(1);
  for (int i = 0; i < kDraws; ++i) {
    const float x = filter.sample({uniform(random), 0.5f}).x;
    ++counts[static_cast<size_t>(std::clamp(static_cast<int>((x + 1) / 2 * kBins), 0, kBins - 1))];
  }
  EXPECT_GT(goodness_of_fit(counts, expected), kLeastChance);
}

TEST(AliasTable, DrawsInProportionToWeightsAndNeverWhatWeighsNothing) {
  const std::vector<float> weights = {1, 0, 5, 0.25f, 0, 3};
  const AliasTable table(weights);
  std::vector<double> counts(weights.size());
  std::mt19937 random(1);
  double leftover = 0;
  constexpr int kDraws = 100000;
  for (int i = 0; i < kDraws; ++i) {
    float u = uniform(random);
    ++counts[static_cast<size_t>(table.sample(u))];
    ASSERT_TRUE(u >= 0 && u < 1);
    leftover += u / kDraws;
  }
  EXPECT_EQ(counts[1] + counts[4], 0);
  std::vector<double> expected;
  for (const float w : weights) expected.push_back(w / 9.25 * kDraws);
  EXPECT_GT(goodness_of_fit(counts, expected), kLeastChance);
  EXPECT_NEAR(leftover, 0.5, 4 * std::sqrt(1.0 / 12 / kDraws));  // what is left of u is uniform again
  EXPECT_TRUE(AliasTable(std::vector<float>{0, 0}).empty());
}

TEST(Sampler, EveryPairOfDimensionsIsStratified) {
  constexpr int kSamples = 256;
  for (uint32_t vertex = 0; vertex < 3; ++vertex) {
    std::vector<int> cells(kSamples), columns(kSamples);
    for (uint32_t i = 0; i < kSamples; ++i) {
      Sampler sampler(3, 5, i, 7);
      sampler.start_vertex(1, vertex);
      sampler.get1d();
      const glm::vec2 u = sampler.get2d();
      ++cells[static_cast<size_t>(static_cast<int>(u.x * 16) * 16 + static_cast<int>(u.y * 16))];
      ++columns[static_cast<size_t>(u.x * kSamples)];
    }
    for (const int c : cells) EXPECT_EQ(c, 1);  // a (0,8,2)-net in base 2
    for (const int c : columns) EXPECT_EQ(c, 1);
  }
}

// Padding must not tie dimensions together: a bin of one pair says nothing of another.
TEST(Sampler, PairsOfDimensionsAreIndependent) {
  std::vector<double> counts(16 * 16), expected(16 * 16, 64.0 * 256 / 256);
  for (uint32_t seed = 0; seed < 64; ++seed) {
    for (uint32_t i = 0; i < 256; ++i) {
      Sampler sampler(3, 5, i, seed);
      sampler.start_vertex(0, 1);
      const float a = sampler.get2d().x, b = sampler.get2d().x;
      ++counts[static_cast<size_t>(static_cast<int>(a * 16) * 16 + static_cast<int>(b * 16))];
    }
  }
  EXPECT_GT(goodness_of_fit(counts, expected), kLeastChance);
}

}  // namespace
}  // namespace vitrine::trace
