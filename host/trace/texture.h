// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Texture fetches with glTF's wrap modes and KHR_texture_transform. What a ray covers at a surface, its footprint, chooses a MIP
// level whose texels are no larger than it is wide where it is narrowest; within the level the fetch is bilinear, or nearest
// where the sampler magnifies so and for rays that were scattered, which blurs more than any interpolation. The minification
// filters of glTF stand for the mean over the footprint, which many samples of a pixel take anyway.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/scene/scene.h"

namespace vitrine::trace {

using TexCoords = std::array<glm::vec2, 2>;

// Where a texture is looked up, for both sets of coordinates.
struct TexturePoint {
  TexCoords uv{};
  std::array<glm::vec2, 2> footprint{};  // squares of its extents in u and v, before any transform; 0: the finest level
  bool blurred = false;                  // by a scattering: one texel of the footprint stands for it
};

// All textures of a scene, with the MIP levels that its materials use. Keeps references to the scene's pictures.
class Textures {
 public:
  explicit Textures(const Scene& scene);

  // RGBA as stored, in [0, 1]. `reference.image` must be valid.
  glm::vec4 linear(const TextureRef& reference, const TexturePoint& point) const;
  // The same with RGB decoded from sRGB before filtering.
  glm::vec4 srgb(const TextureRef& reference, const TexturePoint& point) const;

 private:
  struct Level {
    int width = 0, height = 0;
    const uint8_t* rgba = nullptr;
  };
  struct Pyramid {
    std::vector<Level> levels;  // finest first; one level where nothing asked for more
    std::vector<std::vector<uint8_t>> coarse;
  };
  enum Encoding : uint8_t { kLinear, kSrgb };
  void build(const Image& image, Encoding encoding, Pyramid& pyramid);
  glm::vec4 fetch(const TextureRef& reference, const TexturePoint& point, Encoding encoding) const;

  std::array<std::vector<Pyramid>, 2> pyramids_;  // by encoding and image
};

}  // namespace vitrine::trace
