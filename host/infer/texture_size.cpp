// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/texture_size.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/infer/identifier_reader.h"

namespace vitrine {
namespace {

constexpr int kSurveySize = 256;      // of identifier textures; coordinates are exact but for half a texel at the border
constexpr float kLargestStep = 0.1f;  // of u, v between neighbours; more is the border of a chart
constexpr double kShare = 0.9;        // of the visible pixels that get enough texels
constexpr int kBandRows = 64;
constexpr int kSizeStep = 8, kMarginTexels = 2;
constexpr float kBinsPerOctave = 16, kFirstOctave = -20;

struct Picture {
  std::span<const glm::vec4> identifiers;
  int width, height;
  const glm::vec4* at(int x, int y) const {
    return x < 0 || y < 0 || x >= width || y >= height
               ? nullptr
               : &identifiers[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }
};

// Change of (u, v) from one supersample to the next along (dx, dy): the smaller of both sides, which does not cross the
// border of a chart unless both do.
std::optional<glm::vec2> step_of(const Picture& picture, int x, int y, int dx, int dy) {
  const glm::vec4 here = *picture.at(x, y);
  std::optional<glm::vec2> best;
  for (const int side : {1, -1}) {
    const glm::vec4* next = picture.at(x + side * dx, y + side * dy);
    if (!next || std::fabs(next->w - here.w) > 0.5f) continue;
    const glm::vec2 step = static_cast<float>(side) * (glm::vec2(*next) - glm::vec2(here));
    if (!best || glm::dot(step, step) < glm::dot(*best, *best)) best = step;
  }
  if (best && glm::dot(*best, *best) > kLargestStep * kLargestStep) best.reset();
  return best;
}

// Supersamples along the picture per unit of u and of v: columns of the inverse Jacobian.
std::optional<glm::vec2> stretch_at(const Picture& picture, int x, int y) {
  const auto along_x = step_of(picture, x, y, 1, 0), along_y = step_of(picture, x, y, 0, 1);
  if (!along_x || !along_y) return std::nullopt;
  const float determinant = std::fabs(along_x->x * along_y->y - along_x->y * along_y->x);
  if (!(determinant > 1e-14f)) return std::nullopt;
  return glm::vec2(std::hypot(along_x->y, along_y->y), std::hypot(along_x->x, along_y->x)) / determinant;
}

// Every second supersample each way is enough for stretch.
std::vector<ObjectSurvey> survey_rows(const Picture& picture, int first, int last, size_t object_count, int supersampling) {
  std::vector<ObjectSurvey> surveys(object_count);
  for (int y = first; y < last; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const glm::vec4& here = *picture.at(x, y);
      if (here.w < 0.5f) continue;
      ObjectSurvey& survey = surveys[static_cast<size_t>(here.w + 0.5f) - 1];
      survey.include(glm::vec2(here));
      if ((x | y) & 1) continue;
      if (const auto stretch = stretch_at(picture, x, y)) survey.count(*stretch / static_cast<float>(supersampling));
    }
  return surveys;
}

int fitted_size(float texels, int max_size) {
  const int limit = std::max(kSizeStep, max_size / kSizeStep * kSizeStep);
  if (!(texels < static_cast<float>(limit))) return limit;
  return std::clamp(static_cast<int>(std::ceil(texels / kSizeStep)) * kSizeStep, kSizeStep, limit);
}

}  // namespace

void ObjectSurvey::include(const glm::vec2& uv) {
  low_ = glm::min(low_, uv);
  high_ = glm::max(high_, uv);
}

void ObjectSurvey::count(const glm::vec2& pixels) {
  for (int d = 0; d < 2; ++d) {
    const float bin = (std::log2(std::max(pixels[d], 1e-9f)) - kFirstOctave) * kBinsPerOctave;
    ++histograms_[static_cast<size_t>(d)][static_cast<size_t>(std::clamp(bin, 0.0f, static_cast<float>(kBins - 1)))];
  }
}

void ObjectSurvey::merge(const ObjectSurvey& other) {
  low_ = glm::min(low_, other.low_);
  high_ = glm::max(high_, other.high_);
  for (size_t d = 0; d < 2; ++d)
    for (size_t bin = 0; bin < kBins; ++bin) histograms_[d][bin] += other.histograms_[d][bin];
}

glm::vec2 ObjectSurvey::pixels_per_unit() const {
  glm::vec2 result(0);
  for (int d = 0; d < 2; ++d) {
    const auto& histogram = histograms_[static_cast<size_t>(d)];
    int64_t total = 0, below = 0;
    for (const int64_t n : histogram) total += n;
    size_t bin = 0;
    while (bin < kBins && static_cast<double>(below) < kShare * static_cast<double>(total)) below += histogram[bin++];
    result[d] = total ? std::exp2(static_cast<float>(bin) / kBinsPerOctave + kFirstOctave) : 0;
  }
  return result;
}

std::vector<ObjectSurvey> survey_objects(TestRenderer& renderer, size_t object_count, int supersampling,
                                         std::span<const GeometryState> states) {
  const Pyramid pyramid(kSurveySize, kSurveySize);
  std::vector<hal::Texture> textures;
  for (size_t i = 0; i < object_count; ++i) {
    const auto texels = identifier_texels(pyramid, static_cast<int>(i));
    textures.push_back(create_pyramid_texture(renderer.gpu(), renderer.drawer(), pyramid, hal::TextureFormat::kRgba32f,
                                              std::as_bytes(std::span(texels))));
  }
  std::vector<ObjectSurvey> surveys(object_count);
  std::vector<glm::vec4> identifiers(static_cast<size_t>(renderer.width()) * static_cast<size_t>(renderer.height()));
  const Picture picture{identifiers, renderer.width(), renderer.height()};
  for (const GeometryState& state : states) {
    renderer.render(state, textures, identifiers);
    const int bands = (picture.height + kBandRows - 1) / kBandRows;
    std::vector<std::vector<ObjectSurvey>> parts(static_cast<size_t>(bands));
    tbb::parallel_for(0, bands, [&](int band) {
      parts[static_cast<size_t>(band)] =
          survey_rows(picture, band * kBandRows, std::min(picture.height, (band + 1) * kBandRows), object_count, supersampling);
    });
    for (const auto& part : parts)
      for (size_t i = 0; i < object_count; ++i) surveys[i].merge(part[i]);
  }
  for (const hal::Texture texture : textures) renderer.gpu().destroy(texture);
  return surveys;
}

void fit_texture(DrawnObject& object, const ObjectSurvey& survey, float texels_per_pixel, int max_size) {
  glm::vec2 low = survey.low() - 0.5f / kSurveySize, high = survey.high() + 0.5f / kSurveySize;  // identifiers clamp there
  std::array<int, 2> size{};
  for (int d = 0; d < 2; ++d) {
    const float density = survey.pixels_per_unit()[d] * texels_per_pixel;
    size[static_cast<size_t>(d)] = fitted_size((high[d] - low[d]) * density + 2 * kMarginTexels, max_size);
    const auto texels = static_cast<float>(size[static_cast<size_t>(d)]);
    const float margin = (high[d] - low[d]) * kMarginTexels / (texels - 2 * kMarginTexels);
    low[d] -= margin;
    high[d] += margin;
  }
  object.texture_width = size[0];
  object.texture_height = size[1];
  for (MeshVertex& vertex : object.vertices) {
    vertex.u = (vertex.u - low.x) / (high.x - low.x);
    vertex.v = (vertex.v - low.y) / (high.y - low.y);
  }
}

}  // namespace vitrine
