// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The engine's objects: made at load, their textures composed when what is shown of them changes, drawn every frame.
#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>

#include "target/camera.h"
#include "target/engine_state.h"
#include "target/mip.h"

namespace vitrine {

Engine::State::~State() {
  if (!gpu) return;
  for (const ObjectState& object : objects) {
    gpu->destroy(object.texture);
    gpu->destroy(object.mesh.mesh);
  }
  drawer.destroy();
}

Status Engine::State::create_objects(hal::Gpu& device) {
  const fb::Image& directory = image.directory();
  gpu = &device;
  image.read_rig(buffers.nodes, buffers.tracks);
  buffers.radiance[0] = make_radiance_table();
  auto made = SceneDrawer::create(device, {static_cast<int>(directory.width()), static_cast<int>(directory.height()),
                                           static_cast<int>(directory.supersampling()), hal::TextureFormat::kRgba16f});
  if (!made.ok()) return made.status();
  drawer = made.value();
  for (ObjectState& object : objects)
    if (Status status = create_object(object); !status.ok()) return status;
  return {};
}

Status Engine::State::create_object(ObjectState& object) {
  const fb::Object& o = *object.object;
  const auto vertices = buffers.vertices.first(o.vertex_count());
  const auto indices = buffers.indices.first(o.index_count());
  if (Status status = decode_mesh(image, o, vertices, indices); !status.ok()) return status;
  const auto mesh = drawer.create_mesh(vertices, indices, o.culled_index_count());
  if (!mesh.ok()) return mesh.status();
  object.mesh = mesh.value();
  const auto texture = drawer.create_texture(static_cast<int>(o.texture_width()), static_cast<int>(o.texture_height()),
                                             hal::TextureFormat::kRgba16f);
  if (!texture.ok()) return texture.status();
  object.texture = texture.value();
  return {};
}

int Engine::State::describe_terms(const ObjectState& object, std::span<ComposedTerm> terms) const {
  int count = 0;
  for (uint32_t f = object.first_field; f < object.first_field + object.field_count; ++f)
    for (int i = 0; i < shown[f].count; ++i) {
      const Corner& corner = shown[f].samples[static_cast<size_t>(i)];
      const int levels = fields[f].levels_ready(corner.index, cache.pool_of(fields[f]).ready);
      terms[static_cast<size_t>(count++)] = {fields[f].shape.space.flat_from_index(corner.index), levels, corner.weight};
    }
  return count;
}

// The decoded planes of each term, in the order of describe_terms.
void Engine::State::find_leaves(const ObjectState& object, std::span<const ComposedTerm> terms) {
  size_t t = 0;
  for (uint32_t f = object.first_field; f < object.first_field + object.field_count; ++f)
    for (int i = 0; i < shown[f].count; ++i, ++t) {
      LeafTerm& leaf = leaves[t];
      leaf = {.count = 0, .weight = terms[t].weight};
      for (int level = 0; level < terms[t].levels; ++level) {
        const int node = fields[f].shape.node_of(shown[f].samples[static_cast<size_t>(i)].index, level);
        const int32_t slot = fields[f].slot[static_cast<size_t>(node)];
        if (slot >= 0) leaf.planes[static_cast<size_t>(leaf.count++)] = cache.pool_of(fields[f]).planes_of(slot).data();
      }
    }
}

Status Engine::State::compose_object(ObjectState& object) {
  const auto terms = std::span(wanted).first(static_cast<size_t>(describe_terms(object, wanted)));
  const bool same =
      object.composed_count == static_cast<int>(terms.size()) && std::equal(terms.begin(), terms.end(), object.composed.begin());
  if (same) return {};
  find_leaves(object, terms);
  const int w = static_cast<int>(object.object->texture_width()), h = static_cast<int>(object.object->texture_height());
  compose_texture({leaves.data(), terms.size()}, w, h, buffers.radiance[0], buffers.compose_scratch, buffers.texels);
  if (Status status = upload(object); !status.ok()) return status;
  std::copy(terms.begin(), terms.end(), object.composed.begin());
  object.composed_count = static_cast<int>(terms.size());
  return {};
}

Status Engine::State::upload(const ObjectState& object) {
  int w = static_cast<int>(object.object->texture_width()), h = static_cast<int>(object.object->texture_height());
  const int levels = mip_level_count(w, h);
  size_t first = 0;
  for (int level = 0; level < levels; ++level, w = mip_size(w), h = mip_size(h)) {
    const size_t values = 4 * static_cast<size_t>(w) * static_cast<size_t>(h);
    const auto bytes = std::as_bytes(std::span<const uint16_t>(buffers.texels).subspan(first, values));
    if (Status status = gpu->update_texture(object.texture, level, 0, 0, w, h, bytes); !status.ok()) return status;
    stats.upload_bytes_last += bytes.size();
    first += values;
  }
  return {};
}

Status Engine::State::draw(hal::Target output, const Position& position) {
  const fb::Image& directory = image.directory();
  evaluate_rig({buffers.nodes, buffers.tracks}, position, buffers.world_from_node);
  const Camera camera = image.camera();
  const glm::mat4& world_from_camera = buffers.world_from_node[static_cast<size_t>(camera.node)];
  const float aspect = static_cast<float>(directory.width()) / static_cast<float>(directory.height());
  const glm::mat4 clip_from_world = clip_from_camera(camera, aspect) * camera_from_world(world_from_camera);
  if (Status status = drawer.begin(); !status.ok()) return status;
  Status drawn;
  for (const ObjectState& object : objects) {
    glm::mat4 world_from_object = buffers.world_from_node[object.object->node()];
    if (object.object->follows_camera()) world_from_object = glm::translate(glm::mat4(1), glm::vec3(world_from_camera[3]));
    const bool mirrored = glm::determinant(glm::mat3(world_from_object)) < 0;
    const SurfaceTexture texture{object.texture, {}};
    drawn = drawer.draw(object.mesh, clip_from_world * world_from_object, mirrored, {&texture, 1});
    if (!drawn.ok()) break;
  }
  if (Status status = drawer.end(); !status.ok()) return status;
  if (!drawn.ok()) return drawn;
  return drawer.resolve(output, directory.exposure());
}

}  // namespace vitrine
