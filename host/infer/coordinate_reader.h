// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The rendering matrix from one rendering a tap: where the tap reads, as the shader knows it, between which levels, as texels
// that hold their level tell, and the formulas of GL's bilinear and trilinear filters (OpenGL ES 3.0, section 3.8.10).
#pragma once

#include "host/infer/rendering_matrix.h"

namespace vitrine {

class CoordinateReader final : public MatrixReader {
 public:
  // `sizes`: of the texture that each object is drawn with.
  CoordinateReader(TestRenderer& renderer, std::span<const TextureSize> sizes);
  ~CoordinateReader() override;
  CoordinateReader(const CoordinateReader&) = delete;
  CoordinateReader& operator=(const CoordinateReader&) = delete;

  std::vector<StateMatrix> read(std::span<const GeometryState* const> states) override;
  int64_t renderings() const override { return renderings_; }
  const char* method() const override { return "coordinates"; }

 private:
  using Picture = std::vector<glm::vec4>;  // (u, v, level, object + 1) of one tap
  StateMatrix assemble(std::span<const Picture> taps) const;

  TestRenderer* renderer_;
  int64_t renderings_ = 0;
  std::vector<Pyramid> pyramids_;
  std::vector<hal::Texture> identifiers_;
  std::vector<std::vector<Picture>> pictures_;  // per state and tap; kept from one read to the next
};

}  // namespace vitrine
