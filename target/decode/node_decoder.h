// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Decodes one node of the DCT coder: a 2D picture of three planes (Y, Co, Cg) of signed 16-bit values. Integers only,
// bit-exact on every machine. The bitstream is described in formats/NODE_CODING.md. Works in steps, so that the engine can
// stop at the budget's edge and go on in a later frame. Allocates nothing; safe on hostile bytes (a damaged node decodes to
// an error or to some picture, never beyond `planes`, and for no more units than are declared).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "formats/node_coding.h"
#include "formats/status.h"
#include "target/decode/found_levels.h"
#include "target/decode/range_decoder.h"

namespace vitrine {

// Everything about a node that does not stand in its own bytes.
struct NodeDesc {
  int width = 0, height = 0;          // texels, 1..kMaxNodeSize
  uint16_t steps[3] = {1, 1, 1};      // quantizer step per plane, in 1/8 code; >= 1
  std::span<const uint8_t> contexts;  // initial states of this level's contexts (formats/node_coding.h); empty: built-in
  uint64_t units = 0;                 // what the encoder declared; 0: not known, not checked
};

// About 9 KB of plain data without pointers into itself, so it may be copied or moved between steps.
class NodeDecoder {
 public:
  // `planes`: 3 * width * height values, plane-major, rows from v = 0; need not be initialized. An empty `bytes` is the
  // all-zero node. Spans must live until done() or the next start().
  // kMalformed: a size, step or number of contexts out of range; kOutOfMemory: `planes` too short. Then nothing is written.
  Status start(const NodeDesc& desc, std::span<const std::byte> bytes, std::span<int16_t> planes);
  // Decodes tiles until at least `units` more are spent or the node is done; returns the units spent (>= 1 unless done).
  // The sum over all steps of a node is exactly the units that the encoder declared; anything else is kMalformed, found
  // within one coefficient of going beyond them. After an error the node is done and its planes are zero, which adds nothing to
  // any picture.
  Result<uint64_t> step(uint64_t units);
  bool done() const { return done_; }

 private:
  struct Block {
    int x, y, log2;
  };
  struct Symbols;
  void clear_row_of_tiles();
  void decode_block(Symbols& symbols, Block block);
  void decode_leaf(Symbols& symbols, Block block, struct Neighbours near);
  void decode_plane(Symbols& symbols, int plane, Block block, bool coded, Prediction mode);
  void read_levels(Symbols& symbols, int plane, int log2);
  void add_found(int plane, Block block, int16_t* out, ptrdiff_t stride);
  void mark(Block block, uint8_t flags);
  void next_tile();
  uint64_t spent() const { return work_ + kUnitsPerByte * range_.bytes_read(); }
  Status give_up();
  NodePlane plane(int index) const;

  RangeDecoder range_;
  ContextSet contexts_;
  std::array<uint8_t, kMaxNodeSize / kCellSize + kTileCells> above_;  // flags of the cells above the current row of tiles
  std::array<uint8_t, kTileCells> left_;
  FoundLevels levels_;
  std::span<int16_t> planes_;
  std::array<uint16_t, kNodePlanes> steps_{};
  int width_ = 0, height_ = 0, tile_x_ = 0, tile_y_ = 0;
  uint64_t work_ = 0;      // units but for those of bytes
  uint64_t reported_ = 0;  // units that steps have returned
  uint64_t declared_ = 0;
  bool empty_ = false, done_ = true;
};

}  // namespace vitrine
