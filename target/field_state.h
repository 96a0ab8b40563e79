// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// One field as the engine plays it: its grid of nodes, where each is coded, where each stands decoded, and the texture that is
// made of them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "formats/image.h"
#include "formats/node_coder.h"
#include "hal/gpu.h"
#include "target/arena.h"
#include "target/decode/node_decoder.h"
#include "target/reach.h"

namespace vitrine {

// Where a node is.
inline constexpr int32_t kNotResident = -1;
inline constexpr int32_t kAllZero = -2;  // nothing is coded: adds nothing, needs no slot
inline constexpr int32_t kDamaged = -3;  // its bytes did not decode: never shown

// The samples of a field that are shown.
struct ShownField {
  std::array<Corner, kMaxCorners> samples{};
  int count = 0;
};

// What a field's texture is made of: the samples that it blends, and how many levels of each.
struct ComposedCorner {
  int64_t sample = -1;
  int32_t levels = 0;
  float weight = 0;
  bool operator==(const ComposedCorner&) const = default;
};
struct Composition {
  std::array<ComposedCorner, kMaxCorners> corners{};
  int count = 0;  // 0: never composed
  bool operator==(const Composition&) const = default;
};

struct FieldState {
  const fb::Field* field = nullptr;
  FieldShape shape;
  int width = 0, height = 0;
  int corner_count = 1;  // samples shown at once, at most
  uint32_t pool = 0;     // of the cache, by texture size
  std::span<const std::byte> coded;
  std::span<uint8_t> contexts;  // initial states, kContextBytesPerLevel per level
  std::span<uint64_t> offset;   // of each node in `coded`
  std::span<int32_t> slot;      // of each node: a slot of its pool, or one of the constants above
  hal::Texture texture;
  Composition composed;  // what it holds
  // Derived from the shape.
  int nodes_per_block = 0;
  std::array<int, kMaxLevels> first_in_block{};
  std::array<uint64_t, kMaxLevels> window_nodes{};  // of a level, wanted at any one position, at most
  std::array<uint64_t, kMaxLevels> coded_nodes{};   // of a level, in all

  size_t texels() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
  std::span<const std::byte> bytes_of(uint32_t node) const { return coded.subspan(offset[node], field->node_bytes()->Get(node)); }
  NodeDesc desc_of(uint32_t node) const;
  NodeCoder coder() const { return static_cast<NodeCoder>(field->coder()); }
  int step_count() const;  // of decoding a node, at least: tiles of the DCT coder
  bool shows(const ShownField& shown, uint32_t node) const;
  // Nodes that shown samples need and that are neither decoded nor given up.
  int64_t missing(const ShownField& shown, std::span<const uint8_t> slot_ready) const;
  // Levels from the top for which the sample's node is decoded (or all zero): what can be shown of it.
  int levels_ready(const GridIndex& sample, std::span<const uint8_t> slot_ready) const;
  // What can be composed of what is shown.
  Composition composition_of(const ShownField& shown, std::span<const uint8_t> slot_ready) const;
};

// Reads what the directory says; takes no memory.
FieldState describe_field(const ImageView& image, const fb::Field& field, const Motion& motion);
// Takes the node tables and fills them.
void take_node_tables(FieldState& field, Arena& arena);

// Along one axis the cells of a level that are wanted at coordinate x, and in how many frames they can be needed.
struct WantedCell {
  int32_t node_offset = 0;  // what this cell adds to a node's number
  uint32_t frames = 0;
};
// Writes them to `cells` (room for every cell of the axis) and returns how many there are.
size_t wanted_cells(const FieldState& field, const Motion& motion, int level, int axis, float x, std::span<WantedCell> cells);
// Cells of the finest level along the longest axis: room that wanted_cells can need.
size_t most_cells(const FieldState& field);

}  // namespace vitrine
