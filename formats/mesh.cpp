// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/mesh.h"

#include <meshoptimizer.h>

#include <cmath>

#include "formats/image.h"

namespace vitrine {
namespace {

// The codec versions that image version 1 holds (first byte of each stream); later ones would be accepted by later libraries
// and by no earlier reader.
constexpr uint8_t kVertexStream = 0xa0, kIndexStream = 0xe1;

static_assert(sizeof(MeshVertex) == 20);

const unsigned char* stream(std::span<const std::byte> bytes) { return reinterpret_cast<const unsigned char*>(bytes.data()); }

bool begins_with(std::span<const std::byte> bytes, uint8_t lead) {
  return !bytes.empty() && std::to_integer<uint8_t>(bytes.front()) == lead;
}

bool is_finite(const MeshVertex& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.u) && std::isfinite(v.v);
}

Status decode_vertices(std::span<const std::byte> coded, std::span<MeshVertex> vertices) {
  if (!begins_with(coded, kVertexStream) ||
      meshopt_decodeVertexBuffer(vertices.data(), vertices.size(), sizeof(MeshVertex), stream(coded), coded.size()) != 0)
    return {StatusCode::kMalformed, "a mesh's vertices cannot be decoded"};
  for (const MeshVertex& vertex : vertices)
    if (!is_finite(vertex)) return {StatusCode::kMalformed, "a mesh has a vertex that is not finite"};
  return {};
}

Status decode_indices(std::span<const std::byte> coded, std::span<uint32_t> indices, size_t vertex_count) {
  if (!begins_with(coded, kIndexStream) ||
      meshopt_decodeIndexBuffer(indices.data(), indices.size(), sizeof(uint32_t), stream(coded), coded.size()) != 0)
    return {StatusCode::kMalformed, "a mesh's indices cannot be decoded"};
  for (const uint32_t index : indices)
    if (index >= vertex_count) return {StatusCode::kMalformed, "a mesh has an index without a vertex"};
  return {};
}

}  // namespace

Status decode_mesh(const ImageView& image, const fb::Object& object, std::span<MeshVertex> vertices,
                   std::span<uint32_t> indices) {
  if (vertices.size() != object.vertex_count() || indices.size() != object.index_count())
    return {StatusCode::kOutOfMemory, "the arrays for a mesh are not of the sizes that it declares"};
  if (Status status = decode_vertices(image.section(object.vertices()), vertices); !status.ok()) return status;
  return decode_indices(image.section(object.indices()), indices, vertices.size());
}

}  // namespace vitrine
