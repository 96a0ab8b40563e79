// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/field_state.h"

#include <algorithm>

namespace vitrine {
namespace {

int cells_per_block(const FieldShape& shape, int level, int axis) {
  return shape.block_size[axis] / shape.pyramid.cell[level][axis];
}

int cells_along(const FieldShape& shape, int level, int axis) {
  return shape.blocks_along(axis) * cells_per_block(shape, level, axis);
}

int corners_of(const ParameterSpace& space, bool interpolate) {
  int corners = 1;
  for (int a = 0; a < space.axis_count; ++a)
    if (interpolate && space.axes[a].kind != AxisKind::kDiscrete && space.axes[a].samples > 1) corners *= 2;
  return corners;
}

// A run of n samples meets at most this many cells of `width`.
int cells_met(int samples, int width) { return (samples + width - 2) / width + 1; }

uint64_t window_of(const FieldShape& shape, const Motion& motion, int level) {
  uint64_t nodes = 1;
  for (int a = 0; a < shape.space.axis_count; ++a) {
    const AxisShape& along = shape.space.axes[a];
    const int samples = std::min(along.samples, 2 + 2 * samples_ahead(along, motion.max_speed[a], motion.horizon));
    // Where a periodic axis wraps, the run may be cut by the seam into one more piece.
    const int seam = along.kind == AxisKind::kPeriodic ? 1 : 0;
    nodes *=
        static_cast<uint64_t>(std::min(cells_met(samples, shape.pyramid.cell[level][a]) + seam, cells_along(shape, level, a)));
  }
  return nodes;
}

}  // namespace

NodeDesc FieldState::desc_of(uint32_t node) const {
  const auto level = static_cast<uint32_t>(shape.level_of(static_cast<int>(node)));
  NodeDesc desc;
  desc.width = width;
  desc.height = height;
  for (uint32_t p = 0; p < 3; ++p) desc.steps[p] = field->level_steps()->Get(3 * level + p);
  const size_t of_coder = context_bytes_per_level(coder());
  desc.contexts = contexts.subspan(level * of_coder, of_coder);
  desc.units = field->node_units()->Get(node);
  return desc;
}

int FieldState::step_count() const {
  if (coder() == NodeCoder::kSpiht) return 1;
  return ((width + kTileSize - 1) / kTileSize) * ((height + kTileSize - 1) / kTileSize);
}

bool FieldState::shows(const ShownField& shown, uint32_t node) const {
  const int level = shape.level_of(static_cast<int>(node));
  for (int i = 0; i < shown.count; ++i)
    if (shape.node_of(shown.samples[static_cast<size_t>(i)].index, level) == static_cast<int>(node)) return true;
  return false;
}

int64_t FieldState::missing(const ShownField& shown, std::span<const uint8_t> slot_ready) const {
  int64_t count = 0;
  std::array<int, kMaxCorners> nodes;
  for (int level = 0; level < shape.pyramid.level_count; ++level) {
    int distinct = 0;  // corners may share a node
    for (int i = 0; i < shown.count; ++i) {
      const int node = shape.node_of(shown.samples[static_cast<size_t>(i)].index, level);
      if (std::find(nodes.begin(), nodes.begin() + distinct, node) != nodes.begin() + distinct) continue;
      nodes[static_cast<size_t>(distinct++)] = node;
      const int32_t where = slot[static_cast<size_t>(node)];
      count += where == kNotResident || (where >= 0 && !slot_ready[static_cast<size_t>(where)]);
    }
  }
  return count;
}

int FieldState::levels_ready(const GridIndex& sample, std::span<const uint8_t> slot_ready) const {
  for (int level = 0; level < shape.pyramid.level_count; ++level) {
    const int32_t where = slot[static_cast<size_t>(shape.node_of(sample, level))];
    if (where != kAllZero && (where < 0 || !slot_ready[static_cast<size_t>(where)])) return level;
  }
  return shape.pyramid.level_count;
}

Composition FieldState::composition_of(const ShownField& shown, std::span<const uint8_t> slot_ready) const {
  Composition composition;
  composition.count = shown.count;
  for (size_t i = 0; i < static_cast<size_t>(shown.count); ++i) {
    const Corner& corner = shown.samples[i];
    composition.corners[i] = {shape.space.flat_from_index(corner.index), levels_ready(corner.index, slot_ready), corner.weight};
  }
  return composition;
}

FieldState describe_field(const ImageView& image, const fb::Field& field, const Motion& motion) {
  FieldState state;
  state.field = &field;
  state.shape = image.shape_of(field);
  state.width = static_cast<int>(field.texture_width());
  state.height = static_cast<int>(field.texture_height());
  state.corner_count = corners_of(state.shape.space, motion.interpolate);
  state.coded = image.section(field.nodes());
  state.nodes_per_block = state.shape.nodes_per_block();
  int first = 0;
  for (int level = 0; level < state.shape.pyramid.level_count; ++level) {
    const auto l = static_cast<size_t>(level);
    state.first_in_block[l] = first;
    int cells = 1;
    for (int a = 0; a < state.shape.space.axis_count; ++a) cells *= cells_per_block(state.shape, level, a);
    first += cells;
    state.window_nodes[l] = window_of(state.shape, motion, level);
  }
  for (uint32_t node = 0; node < field.node_bytes()->size(); ++node)
    if (field.node_bytes()->Get(node)) ++state.coded_nodes[static_cast<size_t>(state.shape.level_of(static_cast<int>(node)))];
  return state;
}

void take_node_tables(FieldState& field, Arena& arena) {
  const auto& bytes = *field.field->node_bytes();
  field.offset = arena.take<uint64_t>(bytes.size());
  field.slot = arena.take<int32_t>(bytes.size());
  field.contexts = arena.take_uninitialized<uint8_t>(static_cast<size_t>(field.shape.pyramid.level_count) *
                                                     context_bytes_per_level(field.coder()));
  if (field.slot.empty()) return;
  uint64_t offset = 0;
  for (uint32_t node = 0; node < bytes.size(); ++node) {
    field.offset[node] = offset;
    field.slot[node] = bytes.Get(node) ? kNotResident : kAllZero;
    offset += bytes.Get(node);
  }
}

size_t wanted_cells(const FieldState& field, const Motion& motion, int level, int axis, float x, std::span<WantedCell> cells) {
  const FieldShape& shape = field.shape;
  const AxisShape& along = shape.space.axes[axis];
  const int width = shape.pyramid.cell[level][axis], per_block = cells_per_block(shape, level, axis);
  // What one block and one cell along this axis add to a node's number (row-major, last axis fastest).
  int block_stride = field.nodes_per_block, cell_stride = 1;
  for (int a = shape.space.axis_count - 1; a > axis; --a) {
    block_stride *= shape.blocks_along(a);
    cell_stride *= cells_per_block(shape, level, a);
  }
  const int ahead = samples_ahead(along, motion.max_speed[axis], motion.horizon);
  const SampleRun shown = shown_samples(along, motion.interpolate, x), wanted{shown.first - ahead, shown.last + ahead};
  size_t count = 0;
  for (int c = 0; c < cells_along(shape, level, axis); ++c) {
    const int begin = c * width - shape.stagger[axis];
    const int first = std::max(begin, 0), last = std::min(begin + width, along.samples) - 1;
    if (!meets(along, wanted, first, last)) continue;
    const uint32_t frames = frames_along(along, motion.max_speed[axis], motion.interpolate, x, first, last);
    cells[count++] = {c / per_block * block_stride + c % per_block * cell_stride, frames};
  }
  return count;
}

size_t most_cells(const FieldState& field) {
  int most = 1;
  for (int a = 0; a < field.shape.space.axis_count; ++a)
    most = std::max(most, cells_along(field.shape, field.shape.pyramid.level_count - 1, a));
  return static_cast<size_t>(most);
}

}  // namespace vitrine
