// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/sample_plan.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace vitrine::trace {
namespace {

constexpr int kRadius = 3;          // of the neighbourhood that a pixel's variances are estimated from
constexpr int kEdgeSamples = 16;    // where several objects meet: their coverages are to be told
constexpr int kMaxSamples = 4096;   // of a pixel: the sampler's sequence
constexpr float kLeastVariance = 0.1f; // of a layer's mean variance that every pixel of it counts with: rare paths hide from few samples

// What a pixel tells its neighbours of the object that it shows most of.
struct Statistics {
  int object = -1;
  bool edge = false;
  glm::vec3 radiance{0}, diffuse{0}, view{0}, specular{0};  // mean; variances of single samples
};

// Demand of a pixel: the variances of single samples in display codes, weighed by what will be left of them.
struct Demand {
  float diffuse = 0, specular = 0;
};

Statistics statistics_of(const TileSums& tile, int pixel) {
  Statistics s;
  int most = 0, objects = 0;
  tile.for_each(pixel, [&](const PixelObject& o) {
    ++objects;
    if (o.samples <= most) return;
    most = o.samples;
    s.object = o.object;
    s.radiance = o.radiance();
    s.diffuse = o.diffuse.variance();
    s.view = o.view.variance();
    s.specular = o.specular.variance();
  });
  s.edge = objects > 1;
  return s;
}

// The slope of the sRGB curve at a share of display white. Beyond white noise is hardly seen.
float display_slope(float radiance) {
  if (radiance <= 0.0031308f) return 12.92f;
  const float visible = std::clamp(2 - radiance, 0.1f, 1.0f);
  return visible * (1.055f / 2.4f) * std::pow(std::min(radiance, 1.0f), 1 / 2.4f - 1);
}

// The mean over the neighbours of a pixel that show the same object, without itself; all zero where there are none.
Statistics neighbourhood(const std::vector<Statistics>& all, int width, int height, int x, int y) {
  const int object = all[static_cast<size_t>(y * width + x)].object;
  Statistics mean;
  mean.object = object;
  int count = 0;
  for (int v = std::max(0, y - kRadius); v <= std::min(height - 1, y + kRadius); ++v) {
    for (int u = std::max(0, x - kRadius); u <= std::min(width - 1, x + kRadius); ++u) {
      const Statistics& s = all[static_cast<size_t>(v * width + u)];
      if (s.object != object || (u == x && v == y)) continue;
      ++count;
      mean.radiance += s.radiance;
      mean.diffuse += s.diffuse;
      mean.view += s.view;
      mean.specular += s.specular;
    }
  }
  const float scale = count ? 1.0f / static_cast<float>(count) : 0.0f;
  for (glm::vec3* value : {&mean.radiance, &mean.diffuse, &mean.view, &mean.specular}) *value *= scale;
  return mean;
}

Demand demand_of(const Statistics& s, const NoiseTarget& target) {
  glm::vec3 weight;  // squared slopes, the channels' mean
  for (int c = 0; c < 3; ++c) weight[c] = sqr(display_slope(s.radiance[c] / target.white) / target.white) / 3;
  return {glm::dot(weight, s.diffuse / static_cast<float>(target.views) + s.view), glm::dot(weight, s.specular)};
}

// Sums over the pixels of one object.
struct ObjectSums {
  int pixels = 0;
  std::array<double, 2> variance{}, root{};  // of demands: sums, and sums of square roots
};

}  // namespace

SamplePlan::SamplePlan(int width, int height, int samples)
    : width_(width),
      height_(height),
      budgets_(static_cast<size_t>(width) * static_cast<size_t>(height), {samples, samples, samples}) {}

int SamplePlan::most_samples() const {
  int most = 0;
  for (const PixelBudget& b : budgets_) most = std::max(most, b.samples);
  return most;
}

void SamplePlan::revise(const Film& film, const NoiseTarget& target, int object_count) {
  const size_t pixels = budgets_.size();
  std::vector<Statistics> statistics(pixels);
  std::vector<Demand> demands(pixels);
  const auto for_each_pixel = [&](const auto& body) {
    tbb::parallel_for(0, height_, [&](int y) {
      for (int x = 0; x < width_; ++x) body(x, y, static_cast<size_t>(y * width_ + x));
    });
  };
  for_each_pixel([&](int x, int y, size_t i) { statistics[i] = statistics_of(film.tile_at(x, y), Film::pixel_in_tile(x, y)); });
  for_each_pixel([&](int x, int y, size_t i) { demands[i] = demand_of(neighbourhood(statistics, width_, height_, x, y), target); });

  // Objects, and after them what shows none.
  std::vector<ObjectSums> sums(static_cast<size_t>(object_count) + 1);
  const auto sums_of = [&](size_t i) -> ObjectSums& {
    return sums[statistics[i].object < 0 ? sums.size() - 1 : static_cast<size_t>(statistics[i].object)];
  };
  for (size_t i = 0; i < pixels; ++i) {
    ObjectSums& s = sums_of(i);
    ++s.pixels;
    s.variance[0] += demands[i].diffuse;
    s.variance[1] += demands[i].specular;
  }
  for (size_t i = 0; i < pixels; ++i) {
    ObjectSums& s = sums_of(i);
    demands[i].diffuse = std::max(demands[i].diffuse, kLeastVariance * static_cast<float>(s.variance[0] / s.pixels));
    demands[i].specular = std::max(demands[i].specular, kLeastVariance * static_cast<float>(s.variance[1] / s.pixels));
    s.root[0] += std::sqrt(demands[i].diffuse);
    s.root[1] += std::sqrt(demands[i].specular);
  }

  // Budgets for a factor of all k. Never fewer samples than there are.
  const auto budget = [&](int x, int y, size_t i, double factor) {
    const ObjectSums& s = sums_of(i);
    const TileSums& tile = film.tile_at(x, y);
    const int pixel = Film::pixel_in_tile(x, y), have = tile.samples(pixel);
    PixelBudget b;
    const auto count = [&](size_t layer, float variance) {
      const double k = s.root[layer] / (s.pixels * sqr(static_cast<float>(target.error)));
      return std::clamp(static_cast<int>(std::ceil(factor * k * std::sqrt(variance))), std::min(have, 2), kMaxSamples);
    };
    b.diffuse = count(0, demands[i].diffuse);
    b.specular = count(1, demands[i].specular);
    const bool edge = statistics[i].edge || (x > 0 && statistics[i - 1].object != statistics[i].object) ||
                      (y > 0 && statistics[i - static_cast<size_t>(width_)].object != statistics[i].object);
    b.samples = std::max({b.diffuse, b.specular, have, edge ? kEdgeSamples : 0});
    return b;
  };
  const auto mean_samples = [&](double factor) {
    double sum = 0;
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) sum += budget(x, y, static_cast<size_t>(y * width_ + x), factor).samples;
    return sum / static_cast<double>(pixels);
  };
  double factor = 1;
  if (target.error > 0 && mean_samples(1) > target.max_mean_samples) {
    double low = 0;
    for (int step = 0; step < 16; ++step) {
      const double middle = 0.5 * (low + factor);
      (mean_samples(middle) > target.max_mean_samples ? factor : low) = middle;
    }
    factor = low;
  }
  if (target.error > 0) for_each_pixel([&](int x, int y, size_t i) { budgets_[i] = budget(x, y, i, factor); });

  // What is left now.
  std::vector<LayerNoise> squares(sums.size());
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const auto i = static_cast<size_t>(y * width_ + x);
      if (statistics[i].object < 0) continue;
      film.tile_at(x, y).for_each(Film::pixel_in_tile(x, y), [&](const PixelObject& o) {
        if (o.object != statistics[i].object) return;
        auto& s = squares[static_cast<size_t>(o.object)];
        s[0] += demands[i].diffuse / std::max(1, o.diffuse.count);
        s[1] += demands[i].specular / std::max(1, o.specular.count);
      });
    }
  }
  noise_.assign(static_cast<size_t>(object_count), {});
  for (size_t o = 0; o < noise_.size(); ++o)
    for (size_t layer = 0; layer < 2; ++layer)
      if (sums[o].pixels) noise_[o][layer] = std::sqrt(squares[o][layer] / sums[o].pixels);
}

}  // namespace vitrine::trace
