// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/forward_mapping.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/bench/lanczos.h"
#include "host/bench/surface_points.h"

namespace vitrine {
namespace {

constexpr int kPixelHalfWidth = 4, kPixelTaps = 2 * kPixelHalfWidth;
constexpr float kDefinedCoverage = 0.5f;

// A line of pixels continued by mirror images of itself.
int mirrored(int i, int size) {
  const int period = 2 * size, k = ((i % period) + period) % period;
  return k < size ? k : period - 1 - k;
}

// Pixels around a place along one dimension, and what each counts.
struct PixelTaps {
  std::array<int, kPixelTaps> pixel;
  std::array<float, kPixelTaps> weight;
};

PixelTaps taps_at(float place, int size) {
  const float limit = static_cast<float>(size);
  const double center = static_cast<double>(std::clamp(place, -limit, 2 * limit)) - 0.5;
  const int first = static_cast<int>(std::floor(center)) - kPixelHalfWidth + 1;
  PixelTaps taps;
  double sum = 0;
  std::array<double, kPixelTaps> weights;
  for (int k = 0; k < kPixelTaps; ++k) sum += weights[static_cast<size_t>(k)] = lanczos(first + k - center, kPixelHalfWidth);
  for (size_t k = 0; k < kPixelTaps; ++k) {
    taps.pixel[k] = mirrored(first + static_cast<int>(k), size);
    taps.weight[k] = static_cast<float>(weights[k] / sum);
  }
  return taps;
}

glm::vec3 reconstruct(const std::vector<glm::vec3>& picture, int width, int height, const glm::vec2& place) {
  const PixelTaps columns = taps_at(place.x, width), rows = taps_at(place.y, height);
  glm::vec3 sum(0);
  for (size_t j = 0; j < kPixelTaps; ++j) {
    const glm::vec3* row = &picture[static_cast<size_t>(rows.pixel[j]) * static_cast<size_t>(width)];
    for (size_t i = 0; i < kPixelTaps; ++i) sum += rows.weight[j] * columns.weight[i] * row[columns.pixel[i]];
  }
  return glm::max(sum, glm::vec3(0));
}

}  // namespace

PartialPicture object_layers(const Frame& frame, int object, float white) {
  const size_t pixels = static_cast<size_t>(frame.width) * static_cast<size_t>(frame.height);
  PartialPicture layers{frame.width, frame.height, std::vector<glm::vec3>(pixels, glm::vec3(0)), std::vector<uint8_t>(pixels)};
  for (const ObjectFrame& o : frame.objects) {
    if (o.object != object) continue;
    for (size_t i = 0; i < o.coverage.size(); ++i) {
      const auto columns = static_cast<size_t>(o.width);
      const size_t p =
          (static_cast<size_t>(o.y) + i / columns) * static_cast<size_t>(frame.width) + static_cast<size_t>(o.x) + i % columns;
      layers.defined[p] = o.coverage[i] >= kDefinedCoverage;
      layers.values[p] = glm::min(o.diffuse[i], glm::vec3(white)) + glm::min(o.specular[i], glm::vec3(white));
    }
  }
  return layers;
}

LinearTexture map_forward(const DrawnObject& object, const Placement& placement, const glm::mat4& clip_from_object,
                          const PartialPicture& layers) {
  const std::vector<glm::vec3> filled = fill_by_reflection(layers);
  const std::vector<SurfacePoint> points = surface_points(object, placement);
  PartialPicture texels{placement.size.width, placement.size.height, std::vector<glm::vec3>(points.size(), glm::vec3(0)),
                        std::vector<uint8_t>(points.size())};
  tbb::parallel_for(size_t{0}, points.size(), [&](size_t i) {
    if (points[i].triangle < 0) return;
    const auto place = pixel_of(clip_from_object, points[i].position, {layers.width, layers.height});
    if (!place) return;
    texels.values[i] = reconstruct(filled, layers.width, layers.height, *place);
    texels.defined[i] = 1;
  });
  return {texels.width, texels.height, fill_from_neighbors(texels)};
}

}  // namespace vitrine
