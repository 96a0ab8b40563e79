// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Codes meshes as formats/SPEC.md ("Meshes") says: on a grid, reordered for the GPU's caches, then by meshoptimizer's vertex
// and index codecs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/mesh.h"

namespace vitrine {

struct EncodedMesh {
  std::vector<std::byte> vertices, indices;
  uint32_t vertex_count = 0;  // vertices that no triangle uses are dropped
};

// `vertices`: texture coordinates in [0, 1] of their patches; those that lie on the grid come back exactly (host/base/mesh_grid.h).
// `indices`: triangles, each index < vertices.size(), the first `culled_index_count` of them single-sided. Triangles stay on
// their side of that border and keep their winding; within a side they are reordered, and a triangle may begin at another of
// its corners. The result depends on the input alone.
EncodedMesh encode_mesh(std::span<const MeshVertex> vertices, const MeshGrid& grid, std::span<const uint32_t> indices,
                        uint32_t culled_index_count);

}  // namespace vitrine
