// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/coordinate_reader.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "host/infer/identifier_reader.h"
#include "host/infer/matrix_assembly.h"

namespace vitrine {
namespace {

// The two texels of a row that a coordinate lies between, clamped to the edge. In single precision, as the device does it.
struct Neighbours {
  int first, second;
  float weight;  // of the second
};
Neighbours neighbours(float coordinate, int size) {
  const float at = coordinate * static_cast<float>(size) - 0.5f, low = std::floor(at);
  const auto last = static_cast<float>(size - 1);
  return {static_cast<int>(std::clamp(low, 0.0f, last)), static_cast<int>(std::clamp(low + 1, 0.0f, last)), at - low};
}

void add_bilinear(const Pyramid::Level& level, float u, float v, float share, SampleRow& row) {
  const Neighbours x = neighbours(u, level.width), y = neighbours(v, level.height);
  const auto add = [&](int column, int line, float weight) {
    row.add(static_cast<uint32_t>(level.offset) + static_cast<uint32_t>(line * level.width + column), share * weight);
  };
  add(x.first, y.first, (1 - x.weight) * (1 - y.weight));
  add(x.second, y.first, x.weight * (1 - y.weight));
  add(x.first, y.second, (1 - x.weight) * y.weight);
  add(x.second, y.second, x.weight * y.weight);
}

void add_trilinear(const Pyramid& pyramid, const glm::vec4& at, float share, SampleRow& row) {
  const auto& levels = pyramid.levels();
  const float z = std::clamp(at.z, 0.0f, static_cast<float>(levels.size() - 1));
  const auto lower = static_cast<size_t>(z);
  const float upper_share = z - static_cast<float>(lower);
  if (upper_share < 1 - kSmallestWeight) add_bilinear(levels[lower], at.x, at.y, share * (1 - upper_share), row);
  if (upper_share > kSmallestWeight) add_bilinear(levels[lower + 1], at.x, at.y, share * upper_share, row);
}

}  // namespace

CoordinateReader::CoordinateReader(TestRenderer& renderer, std::span<const TextureSize> sizes) : renderer_(&renderer) {
  for (const TextureSize& size : sizes) pyramids_.emplace_back(size.width, size.height);
  identifiers_ = create_identifier_textures(renderer, pyramids_);
}

CoordinateReader::~CoordinateReader() {
  for (const hal::Texture texture : identifiers_) renderer_->gpu().destroy(texture);
}

StateMatrix CoordinateReader::assemble(std::span<const Picture> taps) const {
  const float share = 1.0f / static_cast<float>(taps.size());
  return assemble_matrix(taps[0], renderer_->width(), renderer_->height(), renderer_->supersampling(), pyramids_.size(),
                         static_cast<int>(taps.size()), [&](size_t sample, SampleRow& row) {
                           const Pyramid& pyramid = pyramids_[static_cast<size_t>(object_of(taps[0][sample]))];
                           for (const Picture& tap : taps) add_trilinear(pyramid, tap[sample], share, row);
                         });
}

std::vector<StateMatrix> CoordinateReader::read(std::span<const GeometryState* const> states) {
  if (pictures_.size() < states.size()) pictures_.resize(states.size());
  for (size_t i = 0; i < states.size(); ++i) {
    pictures_[i].resize(static_cast<size_t>(renderer_->taps()));
    for (int t = 0; t < renderer_->taps(); ++t) {
      Picture& picture = pictures_[i][static_cast<size_t>(t)];
      picture.resize(static_cast<size_t>(renderer_->width()) * static_cast<size_t>(renderer_->height()));
      renderer_->render_coordinates(*states[i], identifiers_, t, picture);
      ++renderings_;
    }
  }
  std::vector<StateMatrix> matrices(states.size());
  tbb::parallel_for(size_t{0}, states.size(), [&](size_t i) { matrices[i] = assemble(pictures_[i]); });
  return matrices;
}

}  // namespace vitrine
