// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Decodes one node of the SPIHT coder: as NodeDecoder, but embedded: any prefix of a node's bytes is a node, of less detail.
// Integers only, bit-exact on every machine. The bitstream is described in formats/SPIHT_CODING.md. Works in steps; allocates
// nothing and keeps no lists: beside the planes it needs a map of fixed size. Safe on hostile bytes.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "formats/spiht_syntax.h"
#include "formats/status.h"
#include "target/decode/embedded_range_decoder.h"
#include "target/decode/node_decoder.h"

namespace vitrine {

// About 3 KB of plain data without pointers into itself, so it may be copied or moved between steps.
class SpihtDecoder {
 public:
  // As NodeDecoder::start. `scratch`: spiht_scratch_words(width, height) words, need not be initialized; must live until done().
  Status start(const NodeDesc& desc, std::span<const std::byte> bytes, std::span<int16_t> planes, std::span<uint16_t> scratch);
  // As NodeDecoder::step: one bit of what hangs on one coefficient of the low band, or a few rows of the wavelet, is the least.
  // `planes` hold a picture when the node is done, not before; zeros after an error.
  Result<uint64_t> step(uint64_t units);
  bool done() const { return phase_ == Phase::kDone; }

 private:
  friend struct SpihtSymbols;
  enum class Phase : uint8_t { kClear, kPlaneCounts, kRoots, kColumns, kRows, kDone };

  void advance();
  void clear_row();
  void read_plane_counts();
  void read_root();
  void next_bit_plane();
  void begin_plane(int plane);
  void column_row();
  void texel_row();
  void dequantize_cells(int row);
  void dequantize_low_row(int row);
  void even_row(int i);
  void odd_row(int i);
  const int16_t* source_row(int i) const;
  bool detailed() const { return ((state_.detailed_levels[static_cast<size_t>(plane_)] >> level_) & 1) != 0; }
  int columns() const { return layout_.width[static_cast<size_t>(detailed() ? level_ - 1 : level_)]; }
  int16_t* plane_row(int row) {
    return state_.value[static_cast<size_t>(plane_)] + static_cast<size_t>(row) * static_cast<size_t>(layout_.width[0]);
  }
  int16_t* line(int row) { return lines_.data() + static_cast<size_t>(row) * static_cast<size_t>(layout_.width[0]); }

  EmbeddedRangeDecoder range_;
  SpihtContextSet contexts_;
  SpihtLayout layout_;
  SpihtPlanes state_;
  std::span<int16_t> lines_;
  std::span<uint16_t> maps_;
  std::array<uint16_t, kNodePlanes> steps_{};
  std::array<int, kNodePlanes> bit_planes_{};
  Phase phase_ = Phase::kDone;
  int plane_ = 0, bit_ = 0, x_ = 0, y_ = 0;  // of the next root
  int level_ = 0, row_ = 0;                  // of the next row of the wavelet
  uint64_t spent_ = 0, declared_ = 0;
  bool empty_ = false;
};

}  // namespace vitrine
