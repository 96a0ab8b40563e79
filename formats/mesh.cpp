// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/mesh.h"

#include <meshoptimizer.h>

#include <memory>
#include <new>

#include "formats/compressed.h"
#include "formats/image.h"

namespace vitrine {
namespace {

// The codec versions that image version 1 holds (first byte of each stream); later ones would be accepted by later libraries
// and by no earlier reader.
constexpr uint8_t kVertexStream = 0xa0, kIndexStream = 0xe1;

static_assert(sizeof(GridVertex) == 12);

using Bytes = std::span<const std::byte>;

const unsigned char* stream(Bytes bytes) { return reinterpret_cast<const unsigned char*>(bytes.data()); }

bool begins_with(Bytes bytes, uint8_t lead) { return !bytes.empty() && std::to_integer<uint8_t>(bytes.front()) == lead; }

Status decode_vertices(Bytes coded, const MeshGrid& grid, std::span<GridVertex> steps, std::span<MeshVertex> vertices) {
  if (!begins_with(coded, kVertexStream) ||
      meshopt_decodeVertexBuffer(steps.data(), steps.size(), sizeof(GridVertex), stream(coded), coded.size()) != 0)
    return {StatusCode::kMalformed, "a mesh's vertices cannot be decoded"};
  for (size_t i = 0; i < vertices.size(); ++i) vertices[i] = vertex_on_grid(grid, steps[i]);
  return {};
}

Status decode_indices(Bytes coded, std::span<uint32_t> indices, size_t vertex_count) {
  if (!begins_with(coded, kIndexStream) ||
      meshopt_decodeIndexBuffer(indices.data(), indices.size(), sizeof(uint32_t), stream(coded), coded.size()) != 0)
    return {StatusCode::kMalformed, "a mesh's indices cannot be decoded"};
  for (const uint32_t index : indices)
    if (index >= vertex_count) return {StatusCode::kMalformed, "a mesh has an index without a vertex"};
  return {};
}

MeshGrid grid_of(const fb::Object& object) {
  const fb::Vec3& origin = *object.grid_origin();
  return {glm::vec3(origin.x(), origin.y(), origin.z()), object.grid_step()};
}

}  // namespace

size_t coded_vertex_bound(uint32_t vertex_count) { return meshopt_encodeVertexBufferBound(vertex_count, sizeof(GridVertex)); }

size_t coded_index_bound(uint32_t index_count, uint32_t vertex_count) {
  return meshopt_encodeIndexBufferBound(index_count, vertex_count);
}

Status decode_mesh(const ImageView& image, const fb::Object& object, std::span<MeshVertex> vertices,
                   std::span<uint32_t> indices) {
  if (vertices.size() != object.vertex_count() || indices.size() != object.index_count())
    return {StatusCode::kOutOfMemory, "the arrays for a mesh are not of the sizes that it declares"};
  const size_t vertex_bytes = object.coded_vertex_bytes(), plain_bytes = vertex_bytes + object.coded_index_bytes();
  const std::unique_ptr<std::byte[]> plain(new (std::nothrow) std::byte[plain_bytes]);
  const std::unique_ptr<GridVertex[]> steps(new (std::nothrow) GridVertex[vertices.size()]);
  if (!plain || !steps) return {StatusCode::kOutOfMemory, "there is no memory for a mesh"};
  const std::span<std::byte> coded(plain.get(), plain_bytes);
  if (Status status = expand(image.section(object.mesh()), coded); !status.ok()) return status;
  if (Status status = decode_vertices(coded.first(vertex_bytes), grid_of(object), {steps.get(), vertices.size()}, vertices);
      !status.ok())
    return status;
  return decode_indices(coded.subspan(vertex_bytes), indices, vertices.size());
}

}  // namespace vitrine
