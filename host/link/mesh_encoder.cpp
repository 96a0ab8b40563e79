// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/link/mesh_encoder.h"

#include <meshoptimizer.h>

#include "host/base/mesh_grid.h"

namespace vitrine {
namespace {

std::vector<std::byte> encode_vertices(const std::vector<GridVertex>& vertices) {
  meshopt_encodeVertexVersion(0);
  std::vector<std::byte> coded(meshopt_encodeVertexBufferBound(vertices.size(), sizeof(GridVertex)));
  coded.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(coded.data()), coded.size(), vertices.data(),
                                          vertices.size(), sizeof(GridVertex)));
  return coded;
}

std::vector<std::byte> encode_indices(const std::vector<uint32_t>& indices, size_t vertex_count) {
  meshopt_encodeIndexVersion(1);
  std::vector<std::byte> coded(meshopt_encodeIndexBufferBound(indices.size(), vertex_count));
  coded.resize(
      meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(coded.data()), coded.size(), indices.data(), indices.size()));
  return coded;
}

}  // namespace

EncodedMesh encode_mesh(std::span<const MeshVertex> vertices, const MeshGrid& grid, std::span<const uint32_t> indices,
                        uint32_t culled_index_count) {
  std::vector<GridVertex> steps;
  for (const MeshVertex& vertex : vertices) steps.push_back(nearest_on_grid(grid, vertex));
  std::vector<uint32_t> ordered(indices.size());
  const size_t culled = culled_index_count, rest = indices.size() - culled;
  // Strips: their vertices lie close in the order of first use, which is what the vertex codec and the compressor live on.
  meshopt_optimizeVertexCacheStrip(ordered.data(), indices.data(), culled, vertices.size());
  meshopt_optimizeVertexCacheStrip(ordered.data() + culled, indices.data() + culled, rest, vertices.size());
  std::vector<GridVertex> fetched(vertices.size());
  fetched.resize(meshopt_optimizeVertexFetch(fetched.data(), ordered.data(), ordered.size(), steps.data(), steps.size(),
                                             sizeof(GridVertex)));
  EncodedMesh mesh;
  mesh.vertex_count = static_cast<uint32_t>(fetched.size());
  mesh.vertices = encode_vertices(fetched);
  mesh.indices = encode_indices(ordered, fetched.size());
  return mesh;
}

}  // namespace vitrine
