// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What the engine holds between frames. Small tables (one entry per field or object) are vectors made at load; all that grows
// with the image lies in the caller's block.
#pragma once

#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "target/arena.h"
#include "target/compose.h"
#include "target/draw/scene_drawer.h"
#include "target/engine.h"
#include "target/field_state.h"
#include "target/node_cache.h"
#include "target/scheduler.h"

namespace vitrine {

struct ObjectState {
  const fb::Object* object = nullptr;
  uint32_t first_field = 0, field_count = 0;
  DrawMesh mesh;
};

// Buffers in the block.
struct EngineBuffers {
  std::span<RigNode> nodes;
  std::span<RigTrack> tracks;
  std::span<glm::mat4> world_from_node;
  // Used one after another, the former at load only.
  std::span<MeshVertex> vertices;
  std::span<uint32_t> indices;
  std::span<float> compose_scratch;
  std::span<uint16_t> texels;
  std::span<RadianceTable> radiance;  // one
};

struct Engine::State {
  explicit State(const ImageView& from) : image(from) {}
  ~State();

  // Describes fields and objects and takes all memory; the same whether the arena counts or gives.
  void lay_out(Arena& arena);
  Status create_drawer();
  Status create_objects();
  Status create_object(ObjectState& object);
  Status create_textures();

  void look_from(const Position& position);
  void decode();
  void count_missing();
  Status compose_field(size_t number);
  LeafTerm leaf_of(const FieldState& field, const GridIndex& sample, const ComposedCorner& corner) const;
  Status upload(const FieldState& field);
  Status draw(hal::Target output, const Position& position);
  Status draw_object(const ObjectState& object, const glm::mat4& clip_from_world, const glm::vec3& camera);
  SurfaceTexture surface_of(size_t field) const;

  ImageView image;
  EngineOptions options;
  hal::Gpu* gpu = nullptr;
  SceneDrawer drawer;
  Motion motion;
  std::vector<FieldState> fields;
  std::vector<ObjectState> objects;
  NodeCache cache;
  Scheduler scheduler;
  EngineBuffers buffers;
  std::vector<std::array<float, kMaxAxes>> coordinates;  // per field, in its own space
  std::vector<ShownField> shown;                         // per field
  Viewpoint viewpoint;
  std::array<float, kMaxAxes> last_x{};
  bool settling = false;
  EngineStats stats;
};

}  // namespace vitrine
