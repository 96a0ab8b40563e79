// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The engine's objects: made at load, drawn every frame with the textures of their fields.
#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>

#include "target/camera.h"
#include "target/engine_state.h"

namespace vitrine {

static_assert(limits::kFieldsPerObject == kMaxSurfaceTextures, "an object is drawn with a texture per field");

Engine::State::~State() {
  if (!gpu) return;
  for (const FieldState& field : fields) gpu->destroy(field.texture);
  for (const ObjectState& object : objects) gpu->destroy(object.mesh.mesh);
  drawer.destroy();
}

Status Engine::State::create_drawer() {
  const fb::Image& directory = image.directory();
  uint32_t most_fields = 0;
  for (const ObjectState& object : objects) most_fields = std::max(most_fields, object.field_count);
  const auto made = SceneDrawer::create(*gpu, {.width = static_cast<int>(directory.width()),
                                               .height = static_cast<int>(directory.height()),
                                               .supersampling = static_cast<int>(directory.supersampling()),
                                               .filter = image.filter(),
                                               .max_textures = static_cast<int>(most_fields)});
  if (!made.ok()) return made.status();
  drawer = made.value();
  return {};
}

Status Engine::State::create_objects() {
  image.read_rig(buffers.nodes, buffers.tracks);
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
  return {};
}

// Samples that are shown together lie on the mesh by one map: where they are blended a field has no other.
SurfaceTexture Engine::State::surface_of(size_t field) const {
  const FieldState& state = fields[field];
  return {state.texture, image.map_of(*state.field, state.shape.block_of(shown[field].samples[0].index))};
}

Status Engine::State::draw_object(const ObjectState& object, const glm::mat4& clip_from_world, const glm::vec3& camera) {
  glm::mat4 world_from_object = buffers.world_from_node[object.object->node()];
  if (object.object->follows_camera()) world_from_object = glm::translate(glm::mat4(1), camera);
  const bool mirrored = glm::determinant(glm::mat3(world_from_object)) < 0;
  std::array<SurfaceTexture, kMaxSurfaceTextures> textures;
  for (uint32_t i = 0; i < object.field_count; ++i) textures[i] = surface_of(object.first_field + i);
  return drawer.draw(object.mesh, clip_from_world * world_from_object, mirrored, std::span(textures).first(object.field_count));
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
    drawn = draw_object(object, clip_from_world, glm::vec3(world_from_camera[3]));
    if (!drawn.ok()) break;
  }
  if (Status status = drawer.end(); !status.ok()) return status;
  if (!drawn.ok()) return drawn;
  return drawer.resolve(output, directory.exposure());
}

}  // namespace vitrine
