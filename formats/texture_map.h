// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How a texture lies on a mesh: from the mesh's own coordinates to those of the texture (Hakura 2001, section 3.2). First, in
// each dimension, a branch cut: what lies below it is raised by 1, so that a part of a closed domain that its seam divides
// becomes whole; then an affine map, which crops, turns and stretches what is seen into [0, 1]^2.
#pragma once

#include <array>
#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>

namespace vitrine {

inline constexpr int kTextureMapValues = 8;  // as an image holds them: cut; first row, its offset; second row, its offset

struct TextureMap {
  glm::vec2 cut{0};  // in [0, 1]; 0: none, the mesh's coordinates lie in [0, 1]
  glm::mat2 linear{1};
  glm::vec2 offset{0};

  glm::vec2 unwrapped(const glm::vec2& mesh) const {
    return {mesh.x < cut.x ? mesh.x + 1 : mesh.x, mesh.y < cut.y ? mesh.y + 1 : mesh.y};
  }
  glm::vec2 operator()(const glm::vec2& mesh) const { return linear * unwrapped(mesh) + offset; }
  bool operator==(const TextureMap&) const = default;

  std::array<float, kTextureMapValues> values() const {
    return {cut.x, cut.y, linear[0][0], linear[1][0], offset.x, linear[0][1], linear[1][1], offset.y};
  }
  static TextureMap from(const std::array<float, kTextureMapValues>& v) {
    return {{v[0], v[1]}, glm::mat2(v[2], v[5], v[3], v[6]), {v[4], v[7]}};
  }
};

}  // namespace vitrine
