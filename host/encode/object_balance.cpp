// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/object_balance.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace vitrine {
namespace {

constexpr double kMargin = 0.98;     // of the bound is aimed at
constexpr double kMostWeight = 1e4;  // an object that needs more is at its finest steps
// Error falls with a weight as its power of -0.3 (few bits) to -0.7: between the corrections that would be right at once.
constexpr double kCorrection = 2.5;

size_t object_count(const std::vector<FieldJob>& jobs) {
  size_t count = 0;
  for (const FieldJob& job : jobs) count = std::max(count, static_cast<size_t>(job.source->object) + 1);
  return count;
}

// Screen pixels that the object takes in all grid samples; layers show the same ones.
std::vector<double> object_pixels(const std::vector<FieldJob>& jobs) {
  std::vector<double> pixels(object_count(jobs), 0);
  for (const FieldJob& job : jobs) {
    const FieldSource& source = *job.source;
    double sum = 0;
    for (const std::vector<float>& own : source.importance) sum += std::accumulate(own.begin(), own.end(), 0.0);
    const double samples = source.samples_shown * static_cast<double>(source.space.sample_count());
    double& own = pixels[static_cast<size_t>(source.object)];
    own = std::max(own, samples * sum / static_cast<double>(std::max<size_t>(source.importance.size(), 1)));
  }
  return pixels;
}

}  // namespace

std::vector<double> object_errors(const std::vector<FieldJob>& jobs, const Pass& pass) {
  std::vector<double> errors(object_count(jobs), 0);
  const std::vector<double> pixels = object_pixels(jobs);
  for (size_t f = 0; f < jobs.size(); ++f)
    errors[static_cast<size_t>(jobs[f].source->object)] += jobs[f].source->samples_shown * pass.fields[f].squared_error;
  for (size_t o = 0; o < errors.size(); ++o) errors[o] = pixels[o] > 0 ? errors[o] / pixels[o] : 0;
  return errors;
}

ObjectBalance::ObjectBalance(const std::vector<FieldJob>& jobs, double worst)
    : worst_(worst), pixels_(object_pixels(jobs)), factors_(pixels_.size(), 1.0) {}

double ObjectBalance::bound(const std::vector<double>& errors) const {
  double sum = 0, pixels = 0;
  for (size_t o = 0; o < errors.size(); ++o) sum += errors[o] * pixels_[o], pixels += pixels_[o];
  return pixels > 0 ? worst_ * sum / pixels : 0;
}

bool ObjectBalance::holds(const std::vector<FieldJob>& jobs, const Pass& pass) const {
  if (worst_ <= 0) return true;
  const std::vector<double> errors = object_errors(jobs, pass);
  const double most = bound(errors);
  for (size_t o = 0; o < errors.size(); ++o)
    if (errors[o] > most && factors_[o] < kMostWeight) return false;
  return true;
}

void ObjectBalance::correct(std::vector<FieldJob>& jobs, const Pass& pass) {
  if (worst_ <= 0) return;
  const std::vector<double> errors = object_errors(jobs, pass);
  const double most = kMargin * bound(errors);
  for (size_t o = 0; o < errors.size(); ++o) {
    const double correction = most > 0 ? std::pow(errors[o] / most, kCorrection) : 1;
    factors_[o] = std::clamp(factors_[o] * correction, 1.0, kMostWeight);
  }
  for (FieldJob& job : jobs) job.weight = job.source->weight * factors_[static_cast<size_t>(job.source->object)];
}

}  // namespace vitrine
