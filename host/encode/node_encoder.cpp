// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/node_encoder.h"

#include <bit>

#include "formats/node_syntax.h"
#include "host/encode/block_search.h"
#include "host/encode/range_encoder.h"

namespace vitrine {
namespace {

// The writer that formats/node_syntax.h goes through: counts units as the decoder does.
struct NodeWriter {
  RangeEncoder range;
  ContextSet& contexts;
  CodedSymbols* symbols;
  uint64_t units = 0;

  bool bit(int context, bool value) {
    units += kUnitsPerSymbol;
    range.bit(contexts[static_cast<size_t>(context)], value);
    if (symbols) symbols->push_back(static_cast<uint16_t>(context << 1 | value));
    return value;
  }
  bool raw(bool value) {
    units += kUnitsPerSymbol;
    range.raw(value);
    return value;
  }
  static constexpr bool exhausted() { return false; }
};

}  // namespace

struct NodeEncoder::Impl {
  BlockSearch search;
  CellFlags flags;
  ContextSet contexts;
  CoefficientLevels levels;
  const NodeTask* task = nullptr;

  // As NodeDecoder::decode_block. True when anything but zeros was coded.
  bool write_block(NodeWriter& writer, const TileTree& tree, const Block& block, int tree_node) {
    if (block.x >= task->width || block.y >= task->height) return false;
    const Neighbours near = flags.around(block);
    writer.units += kUnitsPerBlock;
    const Leaf& leaf = tree.leaves[static_cast<size_t>(tree_node)];
    const bool split = tree.split[static_cast<size_t>(tree_node)], skipped = !split && leaf.skipped;
    code_skip(writer, block.log2, near, skipped);
    if (skipped) {
      flags.mark(block, kFlagSkipped);
      return false;
    }
    code_split(writer, block.log2, near, split);
    if (!split) {
      write_leaf(writer, leaf, block, near);
      return true;
    }
    bool any = false;
    for (int i = 0; i < 4; ++i) any |= write_block(writer, tree, block.quarter(i), 4 * tree_node + 1 + i);
    return any;
  }

  void write_leaf(NodeWriter& writer, const Leaf& leaf, const Block& block, Neighbours near) {
    const bool predicted = leaf.mode != Prediction::kZero;
    code_prediction(writer, block.log2, near, leaf.mode);
    code_coded_planes(writer, block.log2, near, leaf.coded);
    const int planes_of_texels = std::popcount(static_cast<unsigned>(leaf.coded)) + (predicted ? kNodePlanes : 0);
    writer.units += static_cast<uint64_t>(planes_of_texels) * units_of_texels(block.log2);
    for (int p = 0; p < kNodePlanes; ++p) {
      if (!((leaf.coded >> p) & 1)) continue;
      leaf.levels[static_cast<size_t>(p)].unpack(levels);
      code_levels(writer, block.log2, p, levels);
      levels.clear();
    }
    flags.mark(block, static_cast<uint8_t>((predicted ? kFlagPredicted : 0) | leaf.coded * kFlagCoded0));
  }
};

NodeEncoder::NodeEncoder() : impl_(std::make_unique<Impl>()) {}
NodeEncoder::~NodeEncoder() = default;

NodeCode NodeEncoder::encode(const NodeTask& task, CodedSymbols* symbols) {
  NodeCode code;
  code.planes.resize(task.planes.size());
  impl_->task = &task;
  impl_->flags.reset(task.width, task.height);
  impl_->search.start(task, code.planes.data());
  load_contexts(task.contexts, impl_->contexts);
  NodeWriter writer{RangeEncoder(code.bytes), impl_->contexts, symbols};
  const size_t symbols_before = symbols ? symbols->size() : 0;
  uint64_t tiles = 0;
  bool any = false;
  for (int y = 0; y < task.height; y += kTileSize) {
    for (int x = 0; x < task.width; x += kTileSize, ++tiles) {
      const TileTree& tree = impl_->search.search_tile(x, y, impl_->contexts);
      any |= impl_->write_block(writer, tree, {x, y, kTileLog2}, 0);
    }
  }
  writer.range.finish();
  if (!any) code.bytes.clear();
  code.units = kUnitsPerNode + tiles * kUnitsPerTile + (any ? writer.units + kUnitsPerByte * code.bytes.size() : 0);
  if (!any && symbols) symbols->resize(symbols_before);
  return code;
}

}  // namespace vitrine
