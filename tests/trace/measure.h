// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Means of noisy estimates with their standard errors, and fits of counts, so that tests compare within what chance allows.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "host/trace/integrator.h"

namespace vitrine::test {

struct Estimate {
  double mean = 0, error = 0;  // standard error of the mean
};

// Independent trials; samples inside a trial may be correlated.
inline Estimate estimate(int trials, const std::function<double(uint32_t seed)>& trial) {
  double sum = 0, squares = 0;
  for (int t = 0; t < trials; ++t) {
    const double v = trial(static_cast<uint32_t>(t + 1));
    sum += v;
    squares += v * v;
  }
  const double mean = sum / trials;
  return {mean, std::sqrt(std::max(squares / trials - mean * mean, 0.0) / (trials - 1))};
}

// Upper tail of the chi-square distribution by Wilson and Hilferty's normal approximation.
inline double chi_square_tail(double x, int degrees) {
  const double k = degrees, z = (std::cbrt(x / k) - (1 - 2 / (9 * k))) / std::sqrt(2 / (9 * k));
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

// The chance that counts so far from what is expected come about; cells expecting fewer than five are pooled.
inline double goodness_of_fit(const std::vector<double>& counts, const std::vector<double>& expected) {
  double chi = 0, pooled_count = 0, pooled_expected = 0;
  int cells = 0;
  const auto add = [&](double count, double expect) {
    chi += (count - expect) * (count - expect) / expect;
    ++cells;
  };
  for (size_t i = 0; i < counts.size(); ++i) {
    if (expected[i] >= 5) {
      add(counts[i], expected[i]);
      continue;
    }
    pooled_count += counts[i];
    pooled_expected += expected[i];
  }
  if (pooled_expected > 1) add(pooled_count, pooled_expected);
  return chi_square_tail(chi, std::max(cells - 1, 1));
}

// A posed scene with its lights, for tracing single rays.
struct Laboratory {
  explicit Laboratory(const Scene& scene, const trace::PathSettings& settings = {})
      : world(posed(scene)), lights(*world), integrator(*world, lights, settings) {}
  static std::unique_ptr<trace::World> posed(const Scene& scene) {
    auto world = std::make_unique<trace::World>(scene);
    world->pose({});
    return world;
  }
  std::unique_ptr<trace::World> world;
  trace::Lights lights;
  trace::Integrator integrator;

  struct Radiance {
    Estimate diffuse, specular, sum;
  };
  // Luminance along one ray. Trials are scrambles of one stratified set of samples, so they are independent.
  Radiance look(const glm::vec3& from, const glm::vec3& direction, int trials = 32, int samples = 256) const {
    std::vector<double> diffuse(static_cast<size_t>(trials)), specular(diffuse), sum(diffuse);
    for (size_t t = 0; t < diffuse.size(); ++t) {
      for (int s = 0; s < samples; ++s) {
        trace::Sampler sampler(17, 4, static_cast<uint32_t>(s), static_cast<uint32_t>(t + 1));
        const trace::CameraSample c = integrator.trace({from, glm::normalize(direction)}, sampler);
        diffuse[t] += trace::luminance(c.diffuse) / samples;
        specular[t] += trace::luminance(c.specular + c.view) / samples;
      }
      sum[t] = diffuse[t] + specular[t];
    }
    const auto of = [&](const std::vector<double>& v) { return estimate(trials, [&](uint32_t seed) { return v[seed - 1]; }); };
    return {of(diffuse), of(specular), of(sum)};
  }
};

}  // namespace vitrine::test

// The estimate agrees with `expected` within three standard errors and `slack`, a bound on what is not noise (tessellation,
// tables): say why it is what it is.
#define EXPECT_ESTIMATE(estimate_, expected, slack)                                            \
  do {                                                                                         \
    const ::vitrine::test::Estimate e_ = (estimate_);                                          \
    EXPECT_NEAR(e_.mean, (expected), 3 * e_.error + (slack)) << "standard error " << e_.error; \
  } while (false)
