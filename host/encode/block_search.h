// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The search for the cheapest way to code one tile: which quadtree, which predictions, which levels.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/node_coding.h"
#include "formats/node_syntax.h"
#include "host/encode/bit_costs.h"
#include "host/encode/node_encoder.h"

namespace vitrine {

struct Block {
  int x, y, log2;
  int size() const { return 1 << log2; }
  Block quarter(int i) const { return {x + (i & 1) * size() / 2, y + (i >> 1) * size() / 2, log2 - 1}; }
};

// One plane's levels, packed.
struct PackedLevels {
  struct Entry {
    ScanPosition at;
    int16_t level;
  };
  std::vector<Entry> entries;
  int last = 0;
  void pack(const CoefficientLevels& levels);
  void unpack(CoefficientLevels& levels) const;  // into cleared levels
};

// A block that is not split.
struct Leaf {
  bool skipped = true;
  Prediction mode = Prediction::kZero;
  int coded = 0;  // bit p: plane p has levels
  std::array<PackedLevels, kNodePlanes> levels;
};

// A tile's quadtree: node 0 is the tile, node 4 i + 1 + q quarter q of node i.
inline constexpr int kTreeNodes = 21;
struct TileTree {
  std::array<bool, kTreeNodes> split{};
  std::array<Leaf, kTreeNodes> leaves;
};

// Flags of a node's cells, with the neighbours that the decoder would see.
class CellFlags {
 public:
  void reset(int width, int height);
  Neighbours around(const Block& block) const;
  void mark(const Block& block, uint8_t flags);

 private:
  int columns_ = 0;
  std::vector<uint8_t> flags_;
};

class BlockSearch {
 public:
  // `reconstruction`: 3 planes that are filled tile by tile with what the decoder will have.
  void start(const NodeTask& task, int16_t* reconstruction);
  // Decides on the tile at (x, y) given the states of the contexts; updates reconstruction and flags.
  const TileTree& search_tile(int x, int y, const ContextSet& contexts);

 private:
  using Texels = std::array<int16_t, kTileSize * kTileSize>;
  using Values = std::array<float, kTileSize * kTileSize>;
  // A way to code a block without splitting it.
  struct Candidate {
    float cost = 0;
    Leaf leaf;
    std::array<Texels, kNodePlanes> prediction;
  };

  void load_tile(int x, int y);
  float weight_of(const Block& block) const;
  float search(const Block& block, int tree_node);
  float try_split(const Block& block, int tree_node, float flag_bits, float limit);
  void find_leaf(const Block& block, Neighbours near, float weight, float limit, float flag_bits);
  void try_leaf(const Block& block, Neighbours near, float weight, Prediction mode, float flag_bits);
  float luma_error(const Block& block, Prediction mode);
  float energy(const Block& block, float weight) const;
  bool has_border(const Block& block) const;
  void keep(const Block& block, int tree_node, bool skip);
  void keep_leaf(const Block& block, const Candidate& best);
  NodePlane plane(int index) const {
    return {reconstruction_ + static_cast<size_t>(index) * texels_, task_->width, task_->height};
  }
  // The block's first value; rows of kTileSize.
  const float* source(const Block& block, int index) const {
    return &source_[static_cast<size_t>(index)][static_cast<size_t>((block.y % kTileSize << kTileLog2) + block.x % kTileSize)];
  }

  const NodeTask* task_ = nullptr;
  int16_t* reconstruction_ = nullptr;
  size_t texels_ = 0;
  CellFlags flags_;
  BitCosts costs_;
  TileTree tree_;
  std::array<Values, kNodePlanes> source_;
  CoefficientLevels levels_;
  std::array<Candidate, 3> best_;  // per size class
  Candidate trial_;
};

}  // namespace vitrine
