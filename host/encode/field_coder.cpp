// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/field_coder.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/encode/block_cells.h"
#include "host/encode/block_kernels.h"

namespace vitrine {
namespace {

constexpr double kImportanceFloor = 0.02;  // of the mean
constexpr int kRecordedNodes = 24;         // per level and block, for the training of contexts

NodeEncoder& thread_encoder() {
  thread_local NodeEncoder encoder;
  return encoder;
}

// What a node should hold, rounded. Shares sum to one at most and leaves lie within a few thousands: no sum reaches 2^30.
CodedPlanes mix(const std::vector<CodedPlanes>& leaves, const BlockCell& cell) {
  std::vector<int32_t> sum(leaves[cell.leaves[0]].size(), 1 << (kShareLog2 - 1));
  for (size_t l = 0; l < cell.leaves.size(); ++l) {
    const int16_t* leaf = leaves[cell.leaves[l]].data();
    const int32_t share = cell.shares[l];
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += share * leaf[i];
  }
  CodedPlanes mixed(sum.size());
  for (size_t i = 0; i < sum.size(); ++i) mixed[i] = static_cast<int16_t>(sum[i] >> kShareLog2);
  return mixed;
}

// Takes a decoded node off a leaf.
void take_off(const std::vector<int16_t>& node, bool subtracted, CodedPlanes& leaf) {
  if (subtracted)
    for (size_t i = 0; i < node.size(); ++i) leaf[i] = static_cast<int16_t>(leaf[i] + node[i]);
  else
    for (size_t i = 0; i < node.size(); ++i) leaf[i] = static_cast<int16_t>(leaf[i] - node[i]);
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

FieldCoder::FieldCoder(const FieldShape& shape, const FieldTextures& textures, const FieldSetting& setting, double price)
    : shape_(shape), textures_(textures), setting_(setting), price_(price) {
  base_ = std::max(kFinestStep, std::sqrt(price / (kPricePerStep2 * textures.reference_importance)));
  for (int level = 0; level < shape.pyramid.level_count; ++level) {
    const double q = base_ * std::pow(samples_per_cell(shape, level), -setting.step_exponent / 2);
    LevelSteps& steps = steps_.emplace_back();
    for (size_t p = 0; p < kNodePlanes; ++p) {
      const double step = std::round(kStepUnitsPerCode * q / std::sqrt(static_cast<double>(kPlaneWeights[p])));
      steps[p] = static_cast<uint16_t>(std::clamp(step, 1.0, 65535.0));
    }
  }
}

NodeCode FieldCoder::encode_cell(const BlockCell& cell, int block, int level, const std::vector<CodedPlanes>& rest,
                                 CodedSymbols* symbols) const {
  const CodedPlanes wanted = mix(rest, cell);
  NodeTask task;
  task.planes = wanted;
  task.width = textures_.width;
  task.height = textures_.height;
  task.steps = steps(level);
  for (size_t p = 0; p < kNodePlanes; ++p) {
    task.weights[p] = kPlaneWeights[p] * static_cast<float>(static_cast<double>(cell.leaves.size()) / price_);
  }
  task.cell_weights = textures_.weights_of(block).cell_importance;
  if (!setting_.contexts.empty()) task.contexts = setting_.contexts[static_cast<size_t>(level)];
  task.thorough = level == 0;
  return thread_encoder().encode(task, symbols);
}

double FieldCoder::squared_error(const CodedPlanes& rest, const std::vector<float>& importance) const {
  const size_t width = static_cast<size_t>(textures_.width), texels = width * static_cast<size_t>(textures_.height);
  double total = 0;
  for (size_t row = 0; row < texels; row += width) {
    total += row_error(&importance[row], &rest[row], &rest[texels + row], &rest[2 * texels + row], textures_.width);
  }
  return total / 3;
}

std::vector<CodedPlanes> FieldCoder::leaves_of(int block) const {
  std::vector<CodedPlanes> leaves;
  for (const GridIndex& sample : samples_of_block(shape_, block))
    leaves.push_back(textures_.leaf(shape_.space.flat_from_index(sample)));
  return leaves;
}

// Cells of a level share no leaves.
void FieldCoder::encode_level(int block, int level, std::vector<CodedPlanes>& rest, CodedBlock& out) const {
  const std::vector<BlockCell> cells = cells_of_level(shape_, block, level);
  const size_t stride = std::max<size_t>(1, (cells.size() + kRecordedNodes - 1) / kRecordedNodes);
  std::vector<CodedSymbols> symbols(cells.size());
  tbb::parallel_for(size_t{0}, cells.size(), [&](size_t c) {
    const BlockCell& cell = cells[c];
    NodeCode code = encode_cell(cell, block, level, rest, c % stride == 0 ? &symbols[c] : nullptr);
    const size_t node = static_cast<size_t>(cell.node);
    out.nodes[node] = std::move(code.bytes);
    out.units[node] = static_cast<uint32_t>(std::min<uint64_t>(code.units, std::numeric_limits<uint32_t>::max()));
    if (out.nodes[node].empty()) return;
    for (size_t l = 0; l < cell.leaves.size(); ++l) take_off(code.planes, cell.subtracted[l], rest[cell.leaves[l]]);
  });
  for (size_t c = 0; c < cells.size(); c += stride)
    if (!symbols[c].empty()) out.symbols[static_cast<size_t>(level)].push_back(std::move(symbols[c]));
}

CodedBlock FieldCoder::encode_block(int block) const {
  const size_t nodes = static_cast<size_t>(shape_.nodes_per_block());
  CodedBlock out;
  out.nodes.resize(nodes);
  out.units.assign(nodes, 0);
  out.symbols.resize(static_cast<size_t>(shape_.pyramid.level_count));
  std::vector<CodedPlanes> rest = leaves_of(block);
  for (int level = 0; level < shape_.pyramid.level_count; ++level) encode_level(block, level, rest, out);
  for (const CodedPlanes& leaf : rest) out.squared_error += squared_error(leaf, textures_.weights_of(block).importance);
  for (const auto& node : out.nodes) out.bytes += node.size();
  return out;
}

}  // namespace vitrine
