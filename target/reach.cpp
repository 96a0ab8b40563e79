// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/reach.h"

#include <algorithm>
#include <cmath>

namespace vitrine {
namespace {

// Positions are floats in [0, 1]: a step of exactly max_speed may come out this much larger, in samples.
constexpr float kSlack = 1e-3f;

float shown_within(const AxisShape& shape, bool interpolate) {
  return interpolate && shape.kind != AxisKind::kDiscrete ? 1.0f : 0.5f;
}

float distance(float x, float low, float high) { return std::max({low - x, x - high, 0.0f}); }

float distance_along(const AxisShape& shape, float x, float low, float high) {
  const float direct = distance(x, low, high);
  if (shape.kind != AxisKind::kPeriodic) return direct;
  const auto turn = static_cast<float>(shape.samples);
  return std::min({direct, distance(x + turn, low, high), distance(x - turn, low, high)});
}

float step_along(const AxisShape& shape, float from, float to) {
  const float direct = std::fabs(to - from);
  return shape.kind == AxisKind::kPeriodic ? std::min(direct, static_cast<float>(shape.samples) - direct) : direct;
}

}  // namespace

uint32_t frames_along(const AxisShape& shape, float max_speed, bool interpolate, float x, int first, int last) {
  if (last < first) return kNever;
  if (shape.samples == 1) return 0;
  const float reach = shown_within(shape, interpolate);
  const float far = distance_along(shape, x, static_cast<float>(first) - reach, static_cast<float>(last) + reach) - kSlack;
  if (far <= 0) return 0;
  if (!(max_speed > 0)) return kNever;
  const float frames = std::ceil(far / max_speed);
  return frames < 1e9f ? static_cast<uint32_t>(frames) : kNever;
}

uint32_t frames_until(const FieldShape& shape, const Motion& motion, const std::array<float, kMaxAxes>& x, int node) {
  const FieldShape::Box box = shape.samples_of(node);
  uint32_t frames = 0;
  for (int a = 0; a < shape.space.axis_count; ++a)
    frames = std::max(
        frames, frames_along(shape.space.axes[a], motion.max_speed[a], motion.interpolate, x[a], box.first[a], box.last[a]));
  return frames;
}

std::array<float, kMaxAxes> coordinates_of(const ParameterSpace& space, const Position& position) {
  std::array<float, kMaxAxes> x{};
  const GridIndex nearest = space.nearest_sample(position);
  for (int a = 0; a < space.axis_count; ++a)
    x[a] = space.axes[a].kind == AxisKind::kDiscrete ? static_cast<float>(nearest[a]) : space.sample_coordinate(a, position[a]);
  return x;
}

bool is_jump(const ParameterSpace& space, const Motion& motion, const std::array<float, kMaxAxes>& from,
             const std::array<float, kMaxAxes>& to) {
  for (int a = 0; a < space.axis_count; ++a)
    if (step_along(space.axes[a], from[a], to[a]) > motion.max_speed[a] + kSlack) return true;
  return false;
}

SampleRun shown_samples(const AxisShape& shape, bool interpolate, float x) {
  if (shape.samples == 1) return {0, 0};
  const int last = shape.kind == AxisKind::kPeriodic ? shape.samples : shape.samples - 1;
  if (!interpolate || shape.kind == AxisKind::kDiscrete) {
    const int nearest = std::min(static_cast<int>(x + 0.5f), last);
    return {nearest, nearest};
  }
  const int low = std::min(static_cast<int>(x), last - 1);
  return {low, low + 1};
}

// A position that has just come to the border of what it shows is already at the next sample's box: hence one more.
int samples_ahead(const AxisShape& shape, float max_speed, uint32_t horizon) {
  if (shape.samples == 1 || !(max_speed > 0)) return 0;
  const double ahead = std::floor(static_cast<double>(max_speed) * horizon + 1e-6) + 1;
  return ahead < shape.samples ? static_cast<int>(ahead) : shape.samples;
}

bool meets(const AxisShape& shape, const SampleRun& run, int first, int last) {
  const auto overlap = [&](int shift) { return first <= run.last + shift && last >= run.first + shift; };
  if (last < first) return false;
  if (shape.kind != AxisKind::kPeriodic) return overlap(0);
  return overlap(0) || overlap(shape.samples) || overlap(-shape.samples);
}

}  // namespace vitrine
