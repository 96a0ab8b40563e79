// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/block_search.h"

#include <algorithm>
#include <utility>

#include "host/encode/block_kernels.h"
#include "host/encode/forward_transform.h"
#include "host/encode/quantize.h"

namespace vitrine {
namespace {

constexpr float kFewBits = 10;                         // a block that costs less than this in all is not worth splitting
constexpr float kLeastPredicted = 2, kLeastCoded = 6;  // bits that a coded block needs at the very least beyond its skip flag

}  // namespace

void PackedLevels::pack(const CoefficientLevels& levels) {
  entries.clear();
  last = levels.last;
  for (int i = 0; i < levels.nonzero_count; ++i) {
    const ScanPosition at = levels.nonzero[static_cast<size_t>(i)];
    entries.push_back({at, levels.at(at.x, at.y)});
  }
}

void PackedLevels::unpack(CoefficientLevels& levels) const {
  levels.last = last;
  levels.nonzero_count = 0;
  for (const Entry& e : entries) {
    levels.at(e.at.x, e.at.y) = e.level;
    levels.nonzero[static_cast<size_t>(levels.nonzero_count++)] = e.at;
  }
}

void CellFlags::reset(int width, int height) {
  columns_ = (width + kTileSize - 1) / kTileSize * kTileCells;
  flags_.assign(static_cast<size_t>(columns_) * static_cast<size_t>((height + kTileSize - 1) / kTileSize * kTileCells),
                kOutsideFlags);
}

Neighbours CellFlags::around(const Block& block) const {
  const size_t at =
      static_cast<size_t>(block.y / kCellSize) * static_cast<size_t>(columns_) + static_cast<size_t>(block.x / kCellSize);
  return {block.x > 0 ? flags_[at - 1] : kOutsideFlags, block.y > 0 ? flags_[at - static_cast<size_t>(columns_)] : kOutsideFlags};
}

void CellFlags::mark(const Block& block, uint8_t flags) {
  const uint8_t value = static_cast<uint8_t>(flags | size_class(block.log2) << kFlagSizeShift);
  const int cells = block.size() / kCellSize;
  for (int y = 0; y < cells; ++y) {
    std::fill_n(&flags_[static_cast<size_t>((block.y / kCellSize + y) * columns_ + block.x / kCellSize)], cells, value);
  }
}

void BlockSearch::start(const NodeTask& task, int16_t* reconstruction) {
  task_ = &task;
  reconstruction_ = reconstruction;
  texels_ = static_cast<size_t>(task.width) * static_cast<size_t>(task.height);
  flags_.reset(task.width, task.height);
}

const TileTree& BlockSearch::search_tile(int x, int y, const ContextSet& contexts) {
  load_tile(x, y);
  costs_.freeze(contexts);
  search({x, y, kTileLog2}, 0);
  return tree_;
}

// Beyond the node's edges its last texels go on.
void BlockSearch::load_tile(int x, int y) {
  for (int p = 0; p < kNodePlanes; ++p) {
    const int16_t* from = task_->planes.data() + static_cast<size_t>(p) * texels_;
    float* out = source_[static_cast<size_t>(p)].data();
    for (int row = 0; row < kTileSize; ++row, out += kTileSize) {
      const int16_t* line = from + static_cast<size_t>(std::min(y + row, task_->height - 1)) * static_cast<size_t>(task_->width);
      const int inside = std::min(kTileSize, task_->width - x);
      for (int i = 0; i < inside; ++i) out[i] = line[x + i];
      std::fill(out + inside, out + kTileSize, static_cast<float>(line[task_->width - 1]));
    }
  }
}

// Mean importance of the cells inside, times the share of the block that is inside.
float BlockSearch::weight_of(const Block& block) const {
  const int columns = std::min(block.size(), task_->width - block.x), rows = std::min(block.size(), task_->height - block.y);
  const float inside = static_cast<float>(columns * rows) / static_cast<float>(block.size() * block.size());
  if (task_->cell_weights.empty()) return inside;
  const int stride = (task_->width + kCellSize - 1) / kCellSize;
  float sum = 0;
  int count = 0;
  for (int y = block.y / kCellSize; y * kCellSize < block.y + rows; ++y) {
    for (int x = block.x / kCellSize; x * kCellSize < block.x + columns; ++x, ++count)
      sum += task_->cell_weights[static_cast<size_t>(y * stride + x)];
  }
  return inside * sum / static_cast<float>(count);
}

float BlockSearch::energy(const Block& block, float weight) const {
  float total = 0;
  for (int p = 0; p < kNodePlanes; ++p) {
    const float sum = block_energy(source(block, p), block.size());
    total += sum * task_->weights[static_cast<size_t>(p)];
  }
  return total * weight;
}

// Whether there is anything but zeros to predict from.
bool BlockSearch::has_border(const Block& block) const {
  for (int p = 0; p < kNodePlanes; ++p) {
    const NodePlane at = plane(p);
    const int columns = std::min(block.size(), at.width - block.x), rows = std::min(block.size(), at.height - block.y);
    const int16_t* corner = at.data + static_cast<ptrdiff_t>(block.y) * at.width + block.x;
    for (int i = 0; block.y > 0 && i < columns; ++i) {
      if (corner[i - at.width] != 0) return true;
    }
    for (int i = 0; block.x > 0 && i < rows; ++i) {
      if (corner[static_cast<ptrdiff_t>(i) * at.width - 1] != 0) return true;
    }
  }
  return false;
}

// Leaves the best choice in tree_, flags_ and the reconstruction; returns its cost in bits.
float BlockSearch::search(const Block& block, int tree_node) {
  if (block.x >= task_->width || block.y >= task_->height) return 0;
  const Neighbours near = flags_.around(block);
  const float weight = weight_of(block), zero_energy = energy(block, weight);
  BitCounter skip{costs_}, code{costs_}, leaf{costs_}, split{costs_};
  code_skip(skip, block.log2, near, true);
  code_skip(code, block.log2, near, false);
  code_split(leaf, block.log2, near, false);
  code_split(split, block.log2, near, true);
  const float skip_cost = zero_energy + skip.bits;
  if (skip_cost <= code.bits + (has_border(block) ? kLeastPredicted : kLeastCoded)) {
    keep(block, tree_node, true);
    return skip_cost;
  }
  find_leaf(block, near, weight, skip_cost, code.bits + leaf.bits);
  const float unsplit_cost = best_[static_cast<size_t>(size_class(block.log2))].cost;
  if (block.log2 > kMinBlockLog2 && unsplit_cost > kFewBits) {
    const float split_cost = try_split(block, tree_node, code.bits + split.bits, unsplit_cost);
    if (split_cost < unsplit_cost) return split_cost;
  }
  keep(block, tree_node, skip_cost <= unsplit_cost);
  return unsplit_cost;
}

// Gives up when it is no longer below `limit`.
float BlockSearch::try_split(const Block& block, int tree_node, float flag_bits, float limit) {
  float cost = flag_bits;
  for (int i = 0; i < 4 && cost < limit; ++i) cost += search(block.quarter(i), 4 * tree_node + 1 + i);
  tree_.split[static_cast<size_t>(tree_node)] = true;
  return cost;
}

// Squared error of a prediction of luma.
float BlockSearch::luma_error(const Block& block, Prediction mode) {
  Texels& prediction = trial_.prediction[0];
  predict_block(mode, plane(0), block.x, block.y, block.log2, prediction.data());
  return block_error(source(block, 0), prediction.data(), block.size());
}

// Fills best_ of this size with what costs less than `limit`: tries the prediction whose error is least (or all that come
// near), and none.
void BlockSearch::find_leaf(const Block& block, Neighbours near, float weight, float limit, float flag_bits) {
  std::array<float, kPredictionCount> error;
  error.fill(block_energy(source(block, 0), block.size()));
  size_t best = 0;
  if (has_border(block)) {
    for (size_t m = 1; m < kPredictionCount; ++m) {
      error[m] = luma_error(block, static_cast<Prediction>(m));
      if (error[m] < error[best]) best = m;
    }
  }
  best_[static_cast<size_t>(size_class(block.log2))].cost = limit;
  try_leaf(block, near, weight, static_cast<Prediction>(best), flag_bits);
  const float near_best = error[best] * (task_->thorough ? 4.0f : 1.0f);
  for (size_t m = 0; m < kPredictionCount; ++m) {
    if (m == best || (m > 0 && best == 0)) continue;
    if (m == 0 ? error[0] <= 3 * error[best] : error[m] < near_best)
      try_leaf(block, near, weight, static_cast<Prediction>(m), flag_bits);
  }
}

void BlockSearch::try_leaf(const Block& block, Neighbours near, float weight, Prediction mode, float flag_bits) {
  Candidate& best = best_[static_cast<size_t>(size_class(block.log2))];
  BitCounter flags{costs_, flag_bits};
  code_prediction(flags, block.log2, near, mode);
  trial_.cost = flags.bits;
  trial_.leaf.skipped = false;
  trial_.leaf.mode = mode;
  trial_.leaf.coded = 0;
  for (int p = 0; p < kNodePlanes && trial_.cost < best.cost; ++p) {
    const size_t index = static_cast<size_t>(p);
    predict_block(mode, plane(p), block.x, block.y, block.log2, trial_.prediction[index].data());
    Values residual, coefficients;
    block_residual(source(block, p), trial_.prediction[index].data(), block.size(), residual.data());
    forward_transform(residual.data(), block.log2, coefficients.data());
    const int context = coded_context(block.log2, near, p, trial_.leaf.coded);
    const QuantizedPlane quantized =
        quantize_plane(coefficients.data(), block.log2, p, task_->steps[index], weight * task_->weights[index], costs_,
                       costs_.of(context, true), costs_.of(context, false), levels_);
    trial_.cost += quantized.cost;
    if (quantized.coded) {
      trial_.leaf.coded |= 1 << p;
      trial_.leaf.levels[index].pack(levels_);
    }
    levels_.clear();
  }
  if (trial_.cost < best.cost) std::swap(trial_, best);
}

void BlockSearch::keep(const Block& block, int tree_node, bool skip) {
  tree_.split[static_cast<size_t>(tree_node)] = false;
  Leaf& leaf = tree_.leaves[static_cast<size_t>(tree_node)];
  leaf.skipped = skip;
  if (skip) {
    for (int p = 0; p < kNodePlanes; ++p) store_zero_block(plane(p), block.x, block.y, block.log2);
    return flags_.mark(block, kFlagSkipped);
  }
  Candidate& best = best_[static_cast<size_t>(size_class(block.log2))];
  keep_leaf(block, best);
  std::swap(leaf, best.leaf);
}

void BlockSearch::keep_leaf(const Block& block, const Candidate& best) {
  Texels residual;
  for (int p = 0; p < kNodePlanes; ++p) {
    const size_t index = static_cast<size_t>(p);
    const bool coded = (best.leaf.coded >> p) & 1;
    if (coded) {
      best.leaf.levels[index].unpack(levels_);
      reconstruct_residual(levels_, block.log2, task_->steps[index], residual.data());
      levels_.clear();
    }
    store_block(best.prediction[index].data(), coded ? residual.data() : nullptr, plane(p), block.x, block.y, block.log2);
  }
  const int predicted = best.leaf.mode != Prediction::kZero ? kFlagPredicted : 0;
  flags_.mark(block, static_cast<uint8_t>(predicted | best.leaf.coded * kFlagCoded0));
}

}  // namespace vitrine
