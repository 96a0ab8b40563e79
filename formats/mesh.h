// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The meshes of an image (formats/SPEC.md): vertices with the texture coordinates of the object's own texture domain, 32-bit
// indices. Vertices lie on a grid of 2^16 steps over the object, texture coordinates on one of 2^15 over [0, 1].
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "formats/status.h"
#include "formats/texture_map.h"

namespace vitrine {

class ImageView;
namespace fb {
struct Object;
}

struct MeshVertex {
  float x, y, z, u, v;
};

struct MeshGrid {
  glm::vec3 origin{0};
  float step = 1;
};
// A vertex in steps of the grid, as it is coded.
struct GridVertex {
  uint16_t x, y, z, patch, u, v;  // patch: TextureMap::patch_of
};
inline constexpr float kTextureSteps = 32768;  // from texture coordinate 0 to 1 of a patch
inline MeshVertex vertex_on_grid(const MeshGrid& grid, const GridVertex& v) {
  return {grid.origin.x + grid.step * static_cast<float>(v.x), grid.origin.y + grid.step * static_cast<float>(v.y),
          grid.origin.z + grid.step * static_cast<float>(v.z),
          static_cast<float>(v.patch) * kPatchStep + static_cast<float>(v.u) / kTextureSteps,
          static_cast<float>(v.v) / kTextureSteps};
}

// What the coded vertices and indices of a mesh may take at most.
size_t coded_vertex_bound(uint32_t vertex_count);
size_t coded_index_bound(uint32_t index_count, uint32_t vertex_count);

// Decodes into the caller's arrays of exactly the counts that the object declares; fails on damaged data or an index out of
// range. Allocates working memory.
Status decode_mesh(const ImageView& image, const fb::Object& object, std::span<MeshVertex> vertices, std::span<uint32_t> indices);

}  // namespace vitrine
