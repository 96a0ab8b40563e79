// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/ray_counts.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace vitrine::trace {
namespace {

constexpr int kGlossFactor = 4;  // glass and mirrors over what also scatters diffusely
constexpr int kReach = 2;  // pixels: the filter's radius, and what a thin edge may move between two centres

// The largest value within kReach along one dimension: `count` values, `step` apart.
void spread(const std::vector<int>& from, std::vector<int>& to, size_t first, size_t step, int count) {
  for (int i = 0; i < count; ++i) {
    int largest = 0;
    for (int j = std::max(0, i - kReach); j <= std::min(count - 1, i + kReach); ++j)
      largest = std::max(largest, from[first + static_cast<size_t>(j) * step]);
    to[first + static_cast<size_t>(i) * step] = largest;
  }
}

}  // namespace

RayCounts::RayCounts(const Integrator& integrator, const CameraRays& camera, int width, int height, int base, int factor)
    : width_(width), counts_(static_cast<size_t>(width) * static_cast<size_t>(height), base) {
  if (factor <= 1) return;
  const auto columns = static_cast<size_t>(width);
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const Ray ray = camera.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      const Gloss gloss = integrator.gloss(ray);
      const int times = gloss == Gloss::kNone ? 1 : gloss == Gloss::kSome ? factor : kGlossFactor * factor;
      counts_[static_cast<size_t>(y) * columns + static_cast<size_t>(x)] = base * times;
    }
  });
  std::vector<int> rows(counts_.size());
  for (size_t y = 0; y < static_cast<size_t>(height); ++y) spread(counts_, rows, y * columns, 1, width);
  for (size_t x = 0; x < columns; ++x) spread(rows, counts_, x, columns, height);
}

}  // namespace vitrine::trace
