// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The textures of the engine's fields: made at load, composed and uploaded when what is shown of a field changes.
#include "target/engine_state.h"
#include "target/mip.h"

namespace vitrine {

Status Engine::State::create_textures() {
  buffers.radiance[0] = make_radiance_table();
  for (FieldState& field : fields) {
    const auto texture = drawer.create_texture(field.width, field.height, hal::TextureFormat::kRgba16f);
    if (!texture.ok()) return texture.status();
    field.texture = texture.value();
  }
  return {};
}

// The decoded planes of a sample's levels, as many as `corner` says.
LeafTerm Engine::State::leaf_of(const FieldState& field, const GridIndex& sample, const ComposedCorner& corner) const {
  LeafTerm leaf{.weight = corner.weight};
  for (int level = 0; level < corner.levels; ++level) {
    const int32_t slot = field.slot[static_cast<size_t>(field.shape.node_of(sample, level))];
    if (slot < 0) continue;
    leaf.planes[static_cast<size_t>(leaf.count)] = cache.pool_of(field).planes_of(slot).data();
    leaf.subtracted[static_cast<size_t>(leaf.count++)] = field.shape.subtracts(sample, level);
  }
  return leaf;
}

Status Engine::State::compose_field(size_t number) {
  FieldState& field = fields[number];
  const Composition wanted = field.composition_of(shown[number], cache.pool_of(field).ready);
  if (wanted == field.composed) return {};
  std::array<LeafTerm, kMaxCorners> leaves;
  const auto count = static_cast<size_t>(wanted.count);
  for (size_t i = 0; i < count; ++i) leaves[i] = leaf_of(field, shown[number].samples[i].index, wanted.corners[i]);
  compose_texture(std::span(leaves).first(count), field.width, field.height, buffers.radiance[0], buffers.compose_scratch,
                  buffers.texels);
  if (Status status = upload(field); !status.ok()) return status;
  field.composed = wanted;
  return {};
}

Status Engine::State::upload(const FieldState& field) {
  int w = field.width, h = field.height;
  const int levels = mip_level_count(w, h);
  size_t first = 0;
  for (int level = 0; level < levels; ++level, w = mip_size(w), h = mip_size(h)) {
    const size_t values = 4 * static_cast<size_t>(w) * static_cast<size_t>(h);
    const auto bytes = std::as_bytes(std::span<const uint16_t>(buffers.texels).subspan(first, values));
    if (Status status = gpu->update_texture(field.texture, level, 0, 0, w, h, bytes); !status.ok()) return status;
    stats.upload_bytes_last += bytes.size();
    first += values;
  }
  return {};
}

}  // namespace vitrine
