// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/decode/node_decoder.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "formats/node_syntax.h"
#include "target/decode/block_kernels.h"

namespace vitrine {

// The reader that formats/node_syntax.h goes through: counts every symbol, and knows when the node has spent more than it may.
struct NodeDecoder::Symbols {
  bool bit(int context, bool) {
    work += kUnitsPerSymbol;
    return range.bit(contexts[context]);
  }
  bool raw(bool) {
    work += kUnitsPerSymbol;
    return range.raw();
  }
  bool exhausted() const { return work + kUnitsPerByte * range.bytes_read() > limit; }

  RangeDecoder range;
  AdaptiveBit* contexts;
  uint64_t work, limit;
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
  planes_ = planes.first(kNodePlanes * texels);
  width_ = desc.width;
  height_ = desc.height;
  above_.fill(kOutsideFlags);
  left_.fill(kOutsideFlags);
  levels_.clear();
  tile_x_ = tile_y_ = 0;
  work_ = kUnitsPerNode;
  reported_ = 0;
  declared_ = desc.units;
  empty_ = bytes.empty();
  done_ = false;
  return {};
}

Result<uint64_t> NodeDecoder::step(uint64_t units) {
  const uint64_t before = reported_, limit = declared_ != 0 ? declared_ : ~uint64_t{0};
  for (bool any = false; !done_ && (!any || spent() - before < units); any = true) {
    if (tile_x_ == 0) clear_row_of_tiles();
    Symbols symbols{range_, contexts_.data(), work_ + kUnitsPerTile, limit};
    if (!empty_) decode_block(symbols, {tile_x_, tile_y_, kTileLog2});
    range_ = symbols.range;
    work_ = symbols.work;
    next_tile();
    if (symbols.exhausted() || (done_ && declared_ != 0 && spent() != declared_)) return give_up();
  }
  reported_ = spent();
  return reported_ - before;
}

Status NodeDecoder::give_up() {
  done_ = true;
  std::fill(planes_.begin(), planes_.end(), int16_t{0});
  return {StatusCode::kMalformed, "node takes other units than it declares"};
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

// Whole rows at once are much quicker than tiles one by one; most of most nodes stays zero.
void NodeDecoder::clear_row_of_tiles() {
  const auto rows = static_cast<size_t>(std::min(kTileSize, height_ - tile_y_)), width = static_cast<size_t>(width_);
  for (int p = 0; p < kNodePlanes; ++p)
    std::memset(plane(p).data + static_cast<size_t>(tile_y_) * width, 0, rows * width * sizeof(int16_t));
}

void NodeDecoder::decode_block(Symbols& symbols, Block block) {
  if (block.x >= width_ || block.y >= height_ || symbols.exhausted()) return;
  const size_t row = static_cast<size_t>(block.y % kTileSize / kCellSize), column = static_cast<size_t>(block.x / kCellSize);
  const Neighbours near{left_[row], above_[column]};
  symbols.work += kUnitsPerBlock;
  if (code_skip(symbols, block.log2, near, false)) return mark(block, kFlagSkipped);
  if (!code_split(symbols, block.log2, near, false)) return decode_leaf(symbols, block, near);
  const int half = 1 << (block.log2 - 1);
  for (int i = 0; i < 4; ++i) decode_block(symbols, {block.x + (i & 1) * half, block.y + (i >> 1) * half, block.log2 - 1});
}

void NodeDecoder::decode_leaf(Symbols& symbols, Block block, Neighbours near) {
  const Prediction mode = code_prediction(symbols, block.log2, near, Prediction::kZero);
  const int coded = code_coded_planes(symbols, block.log2, near, 0);
  const int planes_of_texels = std::popcount(static_cast<unsigned>(coded)) + (mode != Prediction::kZero ? kNodePlanes : 0);
  symbols.work += static_cast<uint64_t>(planes_of_texels) * units_of_texels(block.log2);
  for (int p = 0; p < kNodePlanes && !symbols.exhausted(); ++p) decode_plane(symbols, p, block, (coded >> p) & 1, mode);
  mark(block, static_cast<uint8_t>((mode != Prediction::kZero ? kFlagPredicted : 0) | coded * kFlagCoded0));
}

void NodeDecoder::decode_plane(Symbols& symbols, int index, Block block, bool coded, Prediction mode) {
  if (coded) {
    read_levels(symbols, index, block.log2);
    if (symbols.exhausted()) return;
  }
  const NodePlane to = plane(index);
  const int size = 1 << block.log2, columns = std::min(size, width_ - block.x), rows = std::min(size, height_ - block.y);
  int16_t* texels = to.data + static_cast<ptrdiff_t>(block.y) * width_ + block.x;
  const bool inside = columns == size && rows == size;
  alignas(64) std::array<int16_t, kTileSize * kTileSize> whole;  // of a block that the node's edge cuts
  int16_t* out = inside ? texels : whole.data();
  const ptrdiff_t stride = inside ? width_ : size;
  if (mode != Prediction::kZero)
    predict_texels(mode, border_of(to, block.x, block.y, size), block.log2, out, stride);
  else if (!inside)
    std::fill_n(whole.begin(), size * size, int16_t{0});
  if (coded) add_found(index, block, out, stride);
  for (int row = 0; !inside && row < rows; ++row)
    std::copy_n(out + row * stride, columns, texels + static_cast<ptrdiff_t>(row) * width_);
}

// The innermost loop: all of it in one function, with a coder of its own, whose state the compiler then keeps in registers.
[[gnu::flatten]] void NodeDecoder::read_levels(Symbols& symbols, int plane, int log2) {
  Symbols own = symbols;
  code_levels(own, log2, plane, levels_);
  symbols = own;
}

void NodeDecoder::add_found(int index, Block block, int16_t* out, ptrdiff_t stride) {
  const CoefficientExtent extent{levels_.columns(), levels_.rows()};
  const size_t column = static_cast<size_t>(extent.even_rows());
  alignas(64) std::array<int16_t, kTileSize * kTileSize> coefficients;
  std::memset(coefficients.data(), 0, static_cast<size_t>(extent.even_columns()) * column * sizeof(int16_t));
  for (const auto& [at, level] : levels_.all())
    coefficients[at.x * column + at.y] = dequantize(level, steps_[static_cast<size_t>(index)], block.log2);
  levels_.clear();
  add_residual(coefficients.data(), extent, block.log2, out, stride);
}

void NodeDecoder::mark(Block block, uint8_t flags) {
  const uint8_t value = static_cast<uint8_t>(flags | (block.log2 - kMinBlockLog2) << kFlagSizeShift);
  const size_t cells = size_t{1} << (block.log2 - kMinBlockLog2);
  std::fill_n(&left_[static_cast<size_t>(block.y % kTileSize / kCellSize)], cells, value);
  std::fill_n(&above_[static_cast<size_t>(block.x / kCellSize)], cells, value);
}

}  // namespace vitrine
