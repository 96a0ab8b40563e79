// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/observation.h"

#include <algorithm>
#include <cmath>

namespace vitrine {
namespace {

const ObjectFrame* find_object(const Frame& frame, int object) {
  for (const ObjectFrame& candidate : frame.objects)
    if (candidate.object == object) return &candidate;
  return nullptr;
}

// Calls body(index in the window, index in the object's frame) for pixels that lie in both.
template <typename Body>
void for_each_common(const PixelWindow& window, const ObjectFrame& frame, const Body& body) {
  const int y1 = std::min(window.y + window.height, frame.y + frame.height),
            x1 = std::min(window.x + window.width, frame.x + frame.width);
  for (int y = std::max(window.y, frame.y); y < y1; ++y)
    for (int x = std::max(window.x, frame.x); x < x1; ++x)
      body(static_cast<size_t>(y - window.y) * static_cast<size_t>(window.width) + static_cast<size_t>(x - window.x),
           static_cast<size_t>(y - frame.y) * static_cast<size_t>(frame.width) + static_cast<size_t>(x - frame.x));
}

bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// Of a pixel that the tracer could not tell (not a number, or infinite) nothing counts.
float traced_coverage(const ObjectFrame& frame, size_t pixel) {
  return is_finite(frame.diffuse[pixel]) && is_finite(frame.specular[pixel]) && std::isfinite(frame.coverage[pixel])
             ? frame.coverage[pixel]
             : 0;
}

}  // namespace

Observation make_observation(const FilteredMatrix& matrix, std::vector<float> weight, float share) {
  Observation observation;
  observation.matrix = &matrix;
  observation.share = share;
  observation.weight = std::move(weight);
  observation.scale.resize(observation.weight.size());
  for (size_t p = 0; p < observation.weight.size(); ++p) {
    if (observation.weight[p] <= 0) continue;
    const float ratio = observation.weight[p] / matrix.filtered()[p];
    observation.scale[p] = share * ratio * ratio;
    ++observation.rows;
  }
  return observation;
}

Observation make_observation(const FilteredMatrix& matrix, int object, std::span<const Frame* const> frames, float share) {
  std::vector<float> weight = matrix.coverage(), traced(matrix.pixel_count());
  for (const Frame* frame : frames) {
    std::fill(traced.begin(), traced.end(), 0.0f);
    if (const ObjectFrame* found = find_object(*frame, object))
      for_each_common(matrix.window(), *found, [&](size_t p, size_t q) { traced[p] = traced_coverage(*found, q); });
    for (size_t p = 0; p < traced.size(); ++p) weight[p] = std::min(weight[p], traced[p]);
  }
  for (float& w : weight)
    if (!(w >= kMinCoverage)) w = 0;
  return make_observation(matrix, std::move(weight), share);
}

std::vector<glm::vec3> layer_in_window(const PixelWindow& window, int object, Layer layer, std::span<const Frame* const> frames,
                                       float white) {
  const glm::vec3 brightest(kHeadroom * white);
  std::vector<glm::vec3> values(static_cast<size_t>(window.width) * static_cast<size_t>(window.height), glm::vec3(0));
  const float share = 1.0f / static_cast<float>(frames.size());
  for (const Frame* frame : frames)
    if (const ObjectFrame* found = find_object(*frame, object)) {
      const std::vector<glm::vec3>& light = layer == Layer::kDiffuse ? found->diffuse : found->specular;
      for_each_common(window, *found, [&](size_t p, size_t q) { values[p] += share * glm::min(light[q], brightest); });
    }
  return values;
}

}  // namespace vitrine
