// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/sample_plan.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "formats/color.h"

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

// How much codes change with a share of display white. Beyond white noise is hardly seen.
float display_slope(float radiance) {
  const float visible = std::clamp(2 - radiance, 0.1f, 1.0f);
  return visible * srgb_slope(std::min(radiance, 1.0f));
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

// What the film tells of a whole picture, rows top first.
struct Survey {
  int width = 0, height = 0;
  std::vector<Statistics> statistics;  // per pixel
  std::vector<Demand> demands;         // per pixel
  std::vector<ObjectSums> sums;        // per object, and after them of the pixels that show none

  size_t object_at(size_t pixel) const {
    const int object = statistics[pixel].object;
    return object < 0 ? sums.size() - 1 : static_cast<size_t>(object);
  }
  // An object ends between the pixel and the one left of it or above, or within it.
  bool edge_at(int x, int y) const {
    const auto i = static_cast<size_t>(y * width + x);
    return statistics[i].edge || (x > 0 && statistics[i - 1].object != statistics[i].object) ||
           (y > 0 && statistics[i - static_cast<size_t>(width)].object != statistics[i].object);
  }
};

// In parallel: body(x, y, pixel) may write what belongs to its pixel.
template <typename Body>
void for_each_pixel(int width, int height, const Body& body) {
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) body(x, y, static_cast<size_t>(y * width + x));
  });
}

// The demands' sums by object. Demands far below their object's mean are raised on the way.
void sum_by_object(Survey& survey) {
  for (size_t i = 0; i < survey.demands.size(); ++i) {
    ObjectSums& s = survey.sums[survey.object_at(i)];
    ++s.pixels;
    s.variance[0] += survey.demands[i].diffuse;
    s.variance[1] += survey.demands[i].specular;
  }
  for (size_t i = 0; i < survey.demands.size(); ++i) {
    ObjectSums& s = survey.sums[survey.object_at(i)];
    Demand& d = survey.demands[i];
    d.diffuse = std::max(d.diffuse, kLeastVariance * static_cast<float>(s.variance[0] / s.pixels));
    d.specular = std::max(d.specular, kLeastVariance * static_cast<float>(s.variance[1] / s.pixels));
    s.root[0] += std::sqrt(d.diffuse);
    s.root[1] += std::sqrt(d.specular);
  }
}

Survey survey_of(const Film& film, const NoiseTarget& target, int width, int height, int object_count) {
  const auto pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  Survey survey{width, height, std::vector<Statistics>(pixels), std::vector<Demand>(pixels), {}};
  survey.sums.resize(static_cast<size_t>(object_count) + 1);
  for_each_pixel(width, height, [&](int x, int y, size_t i) {
    survey.statistics[i] = statistics_of(film.tile_at(x, y), Film::pixel_in_tile(x, y));
  });
  for_each_pixel(width, height, [&](int x, int y, size_t i) {
    survey.demands[i] = demand_of(neighbourhood(survey.statistics, width, height, x, y), target);
  });
  sum_by_object(survey);
  return survey;
}

// What pixels are given towards a target with an error above 0. A factor below 1 gives every pixel that share of the samples
// that the target needs.
struct Allotment {
  const Film& film;
  const NoiseTarget& target;
  const Survey& survey;

  // Samples that bring one layer of the pixel to the target.
  int count(size_t pixel, size_t layer, float variance, int have, double factor) const {
    const ObjectSums& s = survey.sums[survey.object_at(pixel)];
    const double k = s.root[layer] / (s.pixels * sqr(static_cast<float>(target.error)));
    return std::clamp(static_cast<int>(std::ceil(factor * k * std::sqrt(variance))), std::min(have, 2), kMaxSamples);
  }
  // Never fewer samples than there are.
  PixelBudget budget(int x, int y, double factor) const {
    const auto i = static_cast<size_t>(y * survey.width + x);
    const int have = film.tile_at(x, y).samples(Film::pixel_in_tile(x, y));
    PixelBudget b;
    b.diffuse = count(i, 0, survey.demands[i].diffuse, have, factor);
    b.specular = count(i, 1, survey.demands[i].specular, have, factor);
    b.samples = std::max({b.diffuse, b.specular, have, survey.edge_at(x, y) ? kEdgeSamples : 0});
    return b;
  }
  double mean_samples(double factor) const {
    double sum = 0;
    for (int y = 0; y < survey.height; ++y)
      for (int x = 0; x < survey.width; ++x) sum += budget(x, y, factor).samples;
    return sum / static_cast<double>(survey.demands.size());
  }
  // The largest that keeps to the target's mean of samples; at most 1.
  double affordable_factor() const {
    if (mean_samples(1) <= target.max_mean_samples) return 1;
    double low = 0, high = 1;
    for (int step = 0; step < 16; ++step) {
      const double middle = 0.5 * (low + high);
      (mean_samples(middle) > target.max_mean_samples ? high : low) = middle;
    }
    return low;
  }
};

// What the samples on the film have left, per object.
std::vector<LayerNoise> noise_left(const Film& film, const Survey& survey) {
  std::vector<LayerNoise> noise(survey.sums.size() - 1);  // squares, summed
  for (int y = 0; y < survey.height; ++y) {
    for (int x = 0; x < survey.width; ++x) {
      const auto i = static_cast<size_t>(y * survey.width + x);
      const int shown = survey.statistics[i].object;
      if (shown < 0) continue;
      film.tile_at(x, y).for_each(Film::pixel_in_tile(x, y), [&](const PixelObject& o) {
        if (o.object != shown) return;
        LayerNoise& n = noise[static_cast<size_t>(shown)];
        n[0] += survey.demands[i].diffuse / std::max(1, o.diffuse.count);
        n[1] += survey.demands[i].specular / std::max(1, o.specular.count);
      });
    }
  }
  for (size_t o = 0; o < noise.size(); ++o)
    for (double& n : noise[o])
      if (survey.sums[o].pixels) n = std::sqrt(n / survey.sums[o].pixels);
  return noise;
}

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
  const Survey survey = survey_of(film, target, width_, height_, object_count);
  if (target.error > 0) {
    const Allotment allotment{film, target, survey};
    const double factor = allotment.affordable_factor();
    for_each_pixel(width_, height_, [&](int x, int y, size_t i) { budgets_[i] = allotment.budget(x, y, factor); });
  }
  noise_ = noise_left(film, survey);
}

}  // namespace vitrine::trace
