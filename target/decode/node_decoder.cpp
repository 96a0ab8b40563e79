// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/decode/node_decoder.h"

#include <algorithm>

#include "formats/node_syntax.h"

namespace vitrine {

// The reader that formats/node_syntax.h goes through: counts every symbol. Keeps the range coder by value while a tile is
// decoded, so that its state can live in registers.
struct NodeSymbols {
  explicit NodeSymbols(NodeDecoder& of) : decoder(of), range(of.range_) {}
  ~NodeSymbols() {
    decoder.range_ = range;
    decoder.spent_ += symbols * kUnitsPerSymbol;
  }
  NodeSymbols(const NodeSymbols&) = delete;
  NodeSymbols& operator=(const NodeSymbols&) = delete;

  bool bit(int context, bool) {
    ++symbols;
    return range.bit(decoder.contexts_[static_cast<size_t>(context)]);
  }
  bool raw(bool) {
    ++symbols;
    return range.raw();
  }

  NodeDecoder& decoder;
  RangeDecoder range;
  uint64_t symbols = 0;
};

Status NodeDecoder::start(const NodeDesc& desc, std::span<const std::byte> bytes, std::span<int16_t> planes) {
  done_ = true;
  if (desc.width < 1 || desc.height < 1 || desc.width > kMaxNodeSize || desc.height > kMaxNodeSize) {
    return {StatusCode::kMalformed, "node size out of range"};
  }
  const size_t texels = static_cast<size_t>(desc.width) * static_cast<size_t>(desc.height);
  if (planes.size() < kNodePlanes * texels) return {StatusCode::kOutOfMemory, "planes too small for the node"};
  for (const uint16_t s : desc.steps) {
    if (s == 0) return {StatusCode::kMalformed, "quantizer step of zero"};
  }
  if (!load_contexts(desc.contexts, contexts_)) return {StatusCode::kMalformed, "wrong number of initial context states"};
  std::copy_n(desc.steps, kNodePlanes, steps_.begin());
  range_.start(bytes);
  planes_ = planes;
  width_ = desc.width;
  height_ = desc.height;
  above_.fill(kOutsideFlags);
  left_.fill(kOutsideFlags);
  levels_.value.fill(0);
  levels_.nonzero_count = levels_.last = 0;
  tile_x_ = tile_y_ = 0;
  spent_ = 0;
  declared_ = desc.units;
  empty_ = bytes.empty();
  done_ = false;
  return {};
}

Result<uint64_t> NodeDecoder::step(uint64_t units) {
  const uint64_t before = spent_;
  while (!done_ && (spent_ == before || spent_ - before < units)) {
    spent_ += kUnitsPerTile;
    if (empty_)
      clear_tile();
    else
      decode_tile();
    next_tile();
    if (declared_ != 0 && (spent_ > declared_ || (done_ && spent_ != declared_))) {
      done_ = true;
      return Status{StatusCode::kMalformed, "node takes other units than it declares"};
    }
  }
  return spent_ - before;
}

NodePlane NodeDecoder::plane(int index) const {
  const size_t texels = static_cast<size_t>(width_) * static_cast<size_t>(height_);
  return {planes_.data() + static_cast<size_t>(index) * texels, width_, height_};
}

void NodeDecoder::next_tile() {
  tile_x_ += kTileSize;
  if (tile_x_ < width_) return;
  tile_x_ = 0;
  tile_y_ += kTileSize;
  left_.fill(kOutsideFlags);
  done_ = tile_y_ >= height_;
}

void NodeDecoder::clear_tile() {
  for (int p = 0; p < kNodePlanes; ++p) store_zero_block(plane(p), tile_x_, tile_y_, kTileLog2);
}

void NodeDecoder::decode_tile() { decode_block({tile_x_, tile_y_, kTileLog2}); }

void NodeDecoder::decode_block(Block block) {
  if (block.x >= width_ || block.y >= height_) return;
  const size_t row = static_cast<size_t>(block.y % kTileSize / kCellSize), column = static_cast<size_t>(block.x / kCellSize);
  const Neighbours near{left_[row], above_[column]};
  bool skipped, split = false;
  {
    NodeSymbols symbols(*this);
    skipped = code_skip(symbols, block.log2, near, false);
    if (!skipped) split = code_split(symbols, block.log2, near, false);
  }
  if (skipped) {
    for (int p = 0; p < kNodePlanes; ++p) store_zero_block(plane(p), block.x, block.y, block.log2);
    return mark(block, kFlagSkipped);
  }
  if (!split || block.log2 == kMinBlockLog2) return decode_leaf(block, near);
  const int half = 1 << (block.log2 - 1);
  for (int i = 0; i < 4; ++i) decode_block({block.x + (i & 1) * half, block.y + (i >> 1) * half, block.log2 - 1});
}

void NodeDecoder::decode_leaf(Block block, Neighbours near) {
  Prediction mode;
  int coded;
  {
    NodeSymbols symbols(*this);
    mode = code_prediction(symbols, block.log2, near, Prediction::kZero);
    coded = code_coded_planes(symbols, block.log2, near, 0);
  }
  spent_ += units_of_block(block.log2, mode != Prediction::kZero);
  for (int p = 0; p < kNodePlanes; ++p) decode_plane(p, block, (coded >> p) & 1, mode);
  mark(block, static_cast<uint8_t>((mode != Prediction::kZero ? kFlagPredicted : 0) | coded * kFlagCoded0));
}

void NodeDecoder::decode_plane(int index, Block block, bool coded, Prediction mode) {
  std::array<int16_t, kTileSize * kTileSize> prediction, residual;
  if (!coded && mode == Prediction::kZero) return store_zero_block(plane(index), block.x, block.y, block.log2);
  predict_block(mode, plane(index), block.x, block.y, block.log2, prediction.data());
  if (coded) {
    {
      NodeSymbols symbols(*this);
      code_levels(symbols, block.log2, index, levels_);
    }
    spent_ += units_of_transform(levels_, block.log2);
    reconstruct_residual(levels_, block.log2, steps_[static_cast<size_t>(index)], residual.data());
    levels_.clear();
  }
  store_block(prediction.data(), coded ? residual.data() : nullptr, plane(index), block.x, block.y, block.log2);
}

void NodeDecoder::mark(Block block, uint8_t flags) {
  const uint8_t value = static_cast<uint8_t>(flags | (block.log2 - kMinBlockLog2) << kFlagSizeShift);
  const int cells = 1 << (block.log2 - kMinBlockLog2);
  for (int i = 0; i < cells; ++i) {
    left_[static_cast<size_t>(block.y % kTileSize / kCellSize + i)] = value;
    above_[static_cast<size_t>(block.x / kCellSize + i)] = value;
  }
}

}  // namespace vitrine
