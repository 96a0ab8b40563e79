// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How a texture lies on a mesh: from the mesh's own coordinates to those of the texture (Hakura 2001, section 3.2). The mesh is
// cut into patches, the coordinates of patch k raised by 2 k in u, and each patch has a map of its own, so that what is seen of
// each lies where the texture has room. A map is, in each dimension, a branch cut: what lies below it is raised by 1, so that a
// part of a closed domain that its seam divides becomes whole; then an affine map, which crops, turns and stretches what is seen
// into [0, 1]^2.
#pragma once

#include <algorithm>
#include <array>
#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>

namespace vitrine {

inline constexpr int kMaxPatches = 8;        // of a mesh
inline constexpr float kPatchStep = 2;       // in u, from patch to patch
inline constexpr int kTextureMapValues = 8;  // of a patch, in an image: cut; first row, its offset; second row, its offset

struct PatchMap {
  glm::vec2 cut{0};  // in [0, 1]; 0: none, the patch's coordinates lie in [0, 1]
  glm::mat2 linear{1};
  glm::vec2 offset{0};

  glm::vec2 unwrapped(const glm::vec2& patch) const {
    return {patch.x < cut.x ? patch.x + 1 : patch.x, patch.y < cut.y ? patch.y + 1 : patch.y};
  }
  glm::vec2 operator()(const glm::vec2& patch) const { return linear * unwrapped(patch) + offset; }
  bool operator==(const PatchMap&) const = default;

  std::array<float, kTextureMapValues> values() const {
    return {cut.x, cut.y, linear[0][0], linear[1][0], offset.x, linear[0][1], linear[1][1], offset.y};
  }
  static PatchMap from(const std::array<float, kTextureMapValues>& v) {
    return {{v[0], v[1]}, glm::mat2(v[2], v[5], v[3], v[6]), {v[4], v[7]}};
  }
};

struct TextureMap {
  int patch_count = 1;                          // in [1, kMaxPatches]
  std::array<PatchMap, kMaxPatches> patches{};  // beyond patch_count: as the last

  TextureMap() = default;
  TextureMap(const PatchMap& only) { patches.fill(only); }

  // To the mesh's own coordinates as they are, all patches raised.
  static TextureMap raised() {
    TextureMap map;
    map.patch_count = kMaxPatches;
    for (int k = 0; k < kMaxPatches; ++k) map.patches[static_cast<size_t>(k)].offset.x = kPatchStep * static_cast<float>(k);
    return map;
  }
  static int patch_of(float mesh_u) {
    return static_cast<int>(std::clamp(mesh_u / kPatchStep, 0.0f, static_cast<float>(kMaxPatches - 1)));
  }
  glm::vec2 operator()(const glm::vec2& mesh) const {
    const int patch = patch_of(mesh.x);
    return patches[static_cast<size_t>(patch)]({mesh.x - kPatchStep * static_cast<float>(patch), mesh.y});
  }
  bool operator==(const TextureMap&) const = default;
};

}  // namespace vitrine
