// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/field_coder.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "host/encode/block_kernels.h"
#include "host/encode/spiht_encoder.h"

namespace vitrine {
namespace {

constexpr double kImportanceFloor = 0.02;  // of the mean
constexpr int kRecordedNodes = 24;         // per level and block, for the training of contexts

// Calls visit(GridIndex) for every sample in a box, row-major.
template <typename Visit>
void for_each_sample(const ParameterSpace& space, const FieldShape::Box& box, const Visit& visit) {
  for (int a = 0; a < space.axis_count; ++a) {
    if (box.last[a] < box.first[a]) return;
  }
  GridIndex at = box.first;
  for (;;) {
    visit(at);
    int a = space.axis_count - 1;
    while (a >= 0 && at[a] == box.last[a]) at[a] = box.first[a], --a;
    if (a < 0) return;
    ++at[a];
  }
}

NodeCode encode_node(NodeCoder coder, const NodeTask& task, CodedSymbols* symbols) {
  thread_local NodeEncoder dct;
  thread_local SpihtEncoder spiht;
  return coder == NodeCoder::kSpiht ? spiht.encode(task, symbols) : dct.encode(task, symbols);
}

// Mean of a cell's leaves, rounded.
void average(const std::vector<const CodedPlanes*>& leaves, CodedPlanes& mean) {
  const size_t count = mean.size();
  const int n = static_cast<int>(leaves.size());
  std::vector<int32_t> sum(count, n / 2);
  for (const CodedPlanes* leaf : leaves) {
    for (size_t i = 0; i < count; ++i) sum[i] += (*leaf)[i];
  }
  if (std::has_single_bit(static_cast<unsigned>(n))) {
    const int shift = std::countr_zero(static_cast<unsigned>(n));
    for (size_t i = 0; i < count; ++i) mean[i] = static_cast<int16_t>(sum[i] >> shift);
  } else {
    for (size_t i = 0; i < count; ++i) mean[i] = static_cast<int16_t>(sum[i] >= 0 ? sum[i] / n : (sum[i] - n + 1) / n);
  }
}

std::vector<float> cell_means(const std::vector<float>& importance, int width, int height, double samples_shown, double floor) {
  const int columns = (width + kCellSize - 1) / kCellSize, rows = (height + kCellSize - 1) / kCellSize;
  std::vector<float> means(static_cast<size_t>(columns * rows));
  std::vector<int> count(means.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const size_t cell = static_cast<size_t>(y / kCellSize * columns + x / kCellSize);
      means[cell] += importance[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
      ++count[cell];
    }
  for (size_t c = 0; c < count.size(); ++c)
    means[c] = static_cast<float>(samples_shown * std::max(static_cast<double>(means[c]) / count[c], floor));
  return means;
}

}  // namespace

void weigh_texels(const std::vector<std::vector<float>>& importance, double samples_shown, FieldTextures& textures) {
  double sum = 0, squares = 0;
  size_t texels = 0;
  for (const std::vector<float>& own : importance) {
    for (const float w : own) sum += w, squares += static_cast<double>(w) * w;
    texels += own.size();
  }
  const double mean = texels ? sum / static_cast<double>(texels) : 0;
  textures.reference_importance = samples_shown * (sum > 0 ? squares / sum : 1);
  const double floor = std::max(kImportanceFloor * (mean > 0 ? mean : 1), 1e-9);
  textures.weights.clear();
  for (const std::vector<float>& own : importance)
    textures.weights.push_back({own, cell_means(own, textures.width, textures.height, samples_shown, floor)});
}

int samples_per_cell(const FieldShape& shape, int level) {
  int n = 1;
  for (int a = 0; a < shape.space.axis_count; ++a) n *= shape.pyramid.cell[static_cast<size_t>(level)][static_cast<size_t>(a)];
  return n;
}

struct FieldCoder::Cell {
  int node;                    // within the block
  std::vector<size_t> leaves;  // places in the block's list of leaves
};

FieldCoder::FieldCoder(const FieldShape& shape, const FieldTextures& textures, const FieldSetting& setting, double price)
    : shape_(shape), textures_(textures), setting_(setting), price_(price) {
  const double base = std::sqrt(price / (kPricePerStep2 * textures.reference_importance));
  for (int level = 0; level < shape.pyramid.level_count; ++level) {
    const double q = base * std::pow(samples_per_cell(shape, level), -setting.step_exponent / 2);
    LevelSteps& steps = steps_.emplace_back();
    for (size_t p = 0; p < kNodePlanes; ++p) {
      steps[p] = static_cast<uint16_t>(std::clamp(
          std::round(kStepUnitsPerCode * q / std::sqrt(static_cast<double>(kPlaneWeights[p]))), double{kFinestStep}, 65535.0));
    }
  }
}

// Leaves of a block are listed in the order of its bounding box.
std::vector<FieldCoder::Cell> FieldCoder::cells_of(int block, int level) const {
  const int per_block = shape_.nodes_per_block();
  GridIndex first{};
  GridIndex extent{};
  for (int a = shape_.space.axis_count - 1, rest = block; a >= 0; --a) {
    const int size = shape_.block_size[static_cast<size_t>(a)], blocks = shape_.blocks_along(a);
    const int start = rest % blocks * size - shape_.stagger[static_cast<size_t>(a)];
    first[static_cast<size_t>(a)] = std::max(start, 0);
    extent[static_cast<size_t>(a)] =
        std::min(start + size, shape_.space.axes[static_cast<size_t>(a)].samples) - first[static_cast<size_t>(a)];
    rest /= blocks;
  }
  std::vector<Cell> cells;
  for (int n = 0; n < per_block; ++n) {
    const int node = block * per_block + n;
    if (shape_.level_of(node) != level) continue;
    Cell cell{n, {}};
    for_each_sample(shape_.space, shape_.samples_of(node), [&](const GridIndex& at) {
      size_t place = 0;
      for (size_t a = 0; a < static_cast<size_t>(shape_.space.axis_count); ++a) {
        place = place * static_cast<size_t>(extent[a]) + static_cast<size_t>(at[a] - first[a]);
      }
      cell.leaves.push_back(place);
    });
    if (!cell.leaves.empty()) cells.push_back(std::move(cell));
  }
  return cells;
}

NodeCode FieldCoder::encode_cell(const Cell& cell, int block, int level, const std::vector<CodedPlanes>& rest,
                                 CodedSymbols* symbols) const {
  CodedPlanes mean;
  NodeTask task;
  task.planes = rest[cell.leaves[0]];
  if (cell.leaves.size() > 1) {
    std::vector<const CodedPlanes*> leaves;
    for (const size_t leaf : cell.leaves) leaves.push_back(&rest[leaf]);
    mean.resize(rest[cell.leaves[0]].size());
    average(leaves, mean);
    task.planes = mean;
  }
  task.width = textures_.width;
  task.height = textures_.height;
  task.steps = steps(level);
  for (size_t p = 0; p < kNodePlanes; ++p) {
    task.weights[p] = kPlaneWeights[p] * static_cast<float>(static_cast<double>(cell.leaves.size()) / price_);
  }
  task.cell_weights = textures_.weights_of(block).cell_importance;
  if (!setting_.contexts.empty()) task.contexts = setting_.contexts[static_cast<size_t>(level)];
  task.thorough = level == 0;
  return encode_node(setting_.coder, task, symbols);
}

double FieldCoder::squared_error(const CodedPlanes& rest, const std::vector<float>& importance) const {
  const size_t width = static_cast<size_t>(textures_.width), texels = width * static_cast<size_t>(textures_.height);
  double total = 0;
  for (size_t row = 0; row < texels; row += width) {
    total += row_error(&importance[row], &rest[row], &rest[texels + row], &rest[2 * texels + row], textures_.width);
  }
  return total / 3;
}

CodedBlock FieldCoder::encode_block(int block) const {
  const int per_block = shape_.nodes_per_block(), levels = shape_.pyramid.level_count;
  CodedBlock out;
  out.nodes.resize(static_cast<size_t>(per_block));
  out.units.assign(static_cast<size_t>(per_block), 0);
  out.symbols.resize(static_cast<size_t>(levels));
  std::vector<CodedPlanes> rest;
  for (const Cell& cell : cells_of(block, levels - 1)) rest.resize(std::max(rest.size(), cell.leaves.back() + 1));
  for (const Cell& cell : cells_of(block, levels - 1)) {
    const FieldShape::Box box = shape_.samples_of(block * per_block + cell.node);
    rest[cell.leaves[0]] = textures_.leaf(shape_.space.flat_from_index(box.first));
  }
  for (int level = 0; level < levels; ++level) {
    const std::vector<Cell> cells = cells_of(block, level);
    const size_t stride = (cells.size() + kRecordedNodes - 1) / kRecordedNodes;
    std::vector<CodedSymbols> symbols(cells.size());
    tbb::parallel_for(size_t{0}, cells.size(), [&](size_t c) {
      NodeCode code = encode_cell(cells[c], block, level, rest, c % stride == 0 ? &symbols[c] : nullptr);
      const size_t node = static_cast<size_t>(cells[c].node);
      out.nodes[node] = std::move(code.bytes);
      out.units[node] = static_cast<uint32_t>(std::min<uint64_t>(code.units, std::numeric_limits<uint32_t>::max()));
      if (out.nodes[node].empty()) return;
      for (const size_t leaf : cells[c].leaves) {
        for (size_t i = 0; i < code.planes.size(); ++i) rest[leaf][i] = static_cast<int16_t>(rest[leaf][i] - code.planes[i]);
      }
    });
    for (size_t c = 0; c < cells.size(); c += std::max<size_t>(stride, 1)) {
      if (!symbols[c].empty()) out.symbols[static_cast<size_t>(level)].push_back(std::move(symbols[c]));
    }
  }
  for (const CodedPlanes& leaf : rest) out.squared_error += squared_error(leaf, textures_.weights_of(block).importance);
  for (const auto& node : out.nodes) out.bytes += node.size();
  return out;
}

}  // namespace vitrine
