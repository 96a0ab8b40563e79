// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/engine.h"

#include <algorithm>
#include <limits>

#include "formats/context_changes.h"
#include "target/engine_state.h"

namespace vitrine {
namespace {

Motion motion_of(const ImageView& image) {
  const fb::Image& directory = image.directory();
  Motion motion;
  motion.interpolate = directory.interpolate();
  motion.horizon = directory.plan()->horizon_frames();
  for (uint32_t a = 0; a < directory.axes()->size(); ++a) {
    const fb::Axis& axis = *directory.axes()->Get(a);
    motion.max_speed[a] = axis.kind() == fb::AxisKind::discrete ? 0.0f : axis.max_speed();
  }
  return motion;
}

}  // namespace

Engine::Engine(std::unique_ptr<State> state) : state_(std::move(state)) {}
Engine::~Engine() = default;

size_t Engine::required_bytes(const ImageView& image) {
  State state(image);
  Arena arena;
  state.lay_out(arena);
  return arena.failed() ? std::numeric_limits<size_t>::max() : arena.used();
}

Result<std::unique_ptr<Engine>> Engine::load(const ImageView& image, hal::Gpu& gpu, std::span<std::byte> block,
                                             const EngineOptions& options) {
  if (reinterpret_cast<uintptr_t>(block.data()) % Arena::kAlignment)
    return Status{StatusCode::kMalformed, "the engine's block is not aligned to 64 bytes"};
  if (block.size() < required_bytes(image))
    return Status{StatusCode::kOutOfMemory, "the engine's block is too small for the image"};
  auto state = std::make_unique<State>(image);
  Arena arena(block);
  state->options = options;
  state->lay_out(arena);
  if (arena.failed()) return Status{StatusCode::kOutOfMemory, "the engine's block is too small for the image"};
  for (FieldState& field : state->fields)
    if (Status status = expand_contexts(context_changes_of(*field.field), default_context_bytes(field.coder()), field.contexts);
        !status.ok())
      return status;
  state->gpu = &gpu;
  if (Status status = state->create_drawer(); !status.ok()) return status;
  if (Status status = state->create_objects(); !status.ok()) return status;
  if (Status status = state->create_textures(); !status.ok()) return status;
  // In unlimited mode what is shown is decoded when it is shown, tops too.
  if (!options.unlimited)
    state->stats.damaged_nodes = state->scheduler.decode_tops(state->fields, state->cache, state->viewpoint).damaged;
  return std::unique_ptr<Engine>(new Engine(std::move(state)));
}

Status Engine::frame(const Position& position, hal::Target output) {
  state_->look_from(position);
  state_->decode();
  state_->count_missing();
  state_->stats.upload_bytes_last = 0;
  for (size_t f = 0; f < state_->fields.size(); ++f)
    if (Status status = state_->compose_field(f); !status.ok()) return status;
  state_->stats.upload_bytes_max = std::max(state_->stats.upload_bytes_max, state_->stats.upload_bytes_last);
  ++state_->stats.frames;
  return state_->draw(output, position);
}

const EngineStats& Engine::stats() const { return state_->stats; }

void Engine::State::lay_out(Arena& arena) {
  const fb::Image& directory = image.directory();
  motion = motion_of(image);
  size_t scratch = 0, texels = 0, vertices = 0, indices = 0;
  for (const fb::Object* object : *directory.objects()) {
    objects.push_back(
        {.object = object, .first_field = static_cast<uint32_t>(fields.size()), .field_count = object->fields()->size()});
    for (const fb::Field* field : *object->fields()) fields.push_back(describe_field(image, *field, motion));
    vertices = std::max<size_t>(vertices, object->vertex_count());
    indices = std::max<size_t>(indices, object->index_count());
  }
  for (const FieldState& field : fields) {
    scratch = std::max(scratch, compose_scratch_floats(field.width, field.height));
    texels = std::max(texels, 4 * texels_with_mips(field.width, field.height));
  }
  buffers.nodes = arena.take<RigNode>(directory.nodes()->size());
  buffers.tracks = arena.take<RigTrack>(directory.tracks()->size());
  buffers.world_from_node = arena.take<glm::mat4>(directory.nodes()->size());
  buffers.vertices = arena.take_uninitialized<MeshVertex>(vertices);
  buffers.indices = arena.take_uninitialized<uint32_t>(indices);
  buffers.compose_scratch = arena.take_uninitialized<float>(scratch);
  buffers.texels = arena.take_uninitialized<uint16_t>(texels);
  buffers.radiance = arena.take_uninitialized<RadianceTable>(1);
  for (FieldState& field : fields) take_node_tables(field, arena);
  scheduler.lay_out(fields, directory.plan()->units_budget(), arena);
  cache.lay_out(fields, directory.plan()->cache_bytes(), arena);
  coordinates.resize(fields.size());
  shown.resize(fields.size());
  viewpoint = {&motion, coordinates, shown};
  stats.cache_bytes = cache.bytes();
}

// Where the hand is, for every field, and which samples that shows.
void Engine::State::look_from(const Position& position) {
  const std::array<float, kMaxAxes> x = coordinates_of(image.space(), position);
  if (stats.frames == 0 || is_jump(image.space(), motion, last_x, x)) settling = true;
  last_x = x;
  for (size_t f = 0; f < fields.size(); ++f) {
    const ParameterSpace& space = fields[f].shape.space;
    coordinates[f] = coordinates_of(space, position);
    if (motion.interpolate) {
      shown[f].count = corners_around(space, position, shown[f].samples);
    } else {
      shown[f].samples[0] = {space.nearest_sample(position), 1.0f};
      shown[f].count = 1;
    }
  }
}

void Engine::State::decode() {
  const DecodeResult result =
      options.unlimited ? scheduler.decode_shown(fields, cache, viewpoint) : scheduler.decode_wanted(fields, cache, viewpoint);
  stats.units_last = result.units;
  stats.units_sum += result.units;
  stats.units_max = std::max(stats.units_max, result.units);
  stats.damaged_nodes += result.damaged;
  if (!options.unlimited && result.units > image.directory().plan()->units_budget()) ++stats.overruns;
}

// A node that is shown and not there is late, unless a jump asked for it at once.
void Engine::State::count_missing() {
  int64_t missing = 0;
  for (size_t f = 0; f < fields.size(); ++f) missing += fields[f].missing(shown[f], cache.pool_of(fields[f]).ready);
  if (missing == 0)
    settling = false;
  else if (settling)
    ++stats.settling_frames;
  else
    stats.late_nodes += missing;
}

}  // namespace vitrine
