// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Closed-loop coding of one field's blocks: each level codes what the decoded coarser levels leave, mixed over the cell.
//
// The measure of error, everywhere in host/encode: importance * samples_shown * (eR^2 + eG^2 + eB^2) / 3, e in codes, summed
// over texels and leaves. In terms of Y, Co, Cg that is eY^2 + eCo^2 / 6 + eCg^2 / 4 (but for the product of eY and eCg,
// which has no preferred sign), hence kPlaneWeights.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/block.h"
#include "formats/node_coding.h"
#include "host/encode/block_cells.h"
#include "host/encode/encode.h"
#include "host/encode/node_encoder.h"

namespace vitrine {

inline constexpr std::array<float, kNodePlanes> kPlaneWeights = {1.0f, 1.0f / 6, 1.0f / 4};
// A step of q codes belongs to a price of kPricePerStep2 * q^2 squared error per bit.
inline constexpr double kPricePerStep2 = 0.10;
// No base step is finer, in codes: about one 8-bit level.
inline constexpr double kFinestStep = 4;

// The leaves of a field, or of a part of its texels, in memory.
struct FieldTextures {
  int width = 0, height = 0;
  std::vector<CodedPlanes> leaves;  // by flat sample; empty: `source` is asked each time
  const FieldSource* source = nullptr;
  struct Weights {
    std::vector<float> importance;       // per texel
    std::vector<float> cell_importance;  // mean per 8 x 8 cell, times samples_shown, not below a floor
  };
  std::vector<Weights> weights;     // as FieldSource::importance
  double reference_importance = 1;  // what a typical seen texel weighs, times samples_shown
  const Weights& weights_of(int block) const {
    return weights[source && !source->block_maps.empty() ? source->block_maps[static_cast<size_t>(block)] : 0];
  }

  CodedPlanes leaf(int64_t sample) const { return leaves.empty() ? source->load(sample) : leaves[static_cast<size_t>(sample)]; }
};
// Fills weights and reference_importance. Importance below 2 % of the mean counts as that much, so that what is hardly ever seen
// still looks like the object.
void weigh_texels(const std::vector<std::vector<float>>& importance, double samples_shown, FieldTextures& textures);

// How a field is coded.
struct FieldSetting {
  PyramidShape pyramid;
  // A level whose cells hold n samples gets steps in proportion to n^(-exponent / 2): 1 would be right if no finer level
  // mended its errors.
  double step_exponent = 1;
  std::vector<std::vector<uint8_t>> contexts;  // per level; empty: built-in
};

struct CodedBlock {
  std::vector<std::vector<uint8_t>> nodes;  // per node of the block
  std::vector<uint32_t> units;
  std::vector<std::vector<CodedSymbols>> symbols;  // per level, of some of its nodes
  double squared_error = 0;                        // as EncodedField
  uint64_t bytes = 0;                              // of the nodes
};

using LevelSteps = std::array<uint16_t, kNodePlanes>;

class FieldCoder {
 public:
  // Keeps references. `price`: squared error per bit.
  FieldCoder(const FieldShape& shape, const FieldTextures& textures, const FieldSetting& setting, double price);
  const LevelSteps& steps(int level) const { return steps_[static_cast<size_t>(level)]; }
  // Whether no lower price would make the steps finer.
  bool finest() const { return base_ <= kFinestStep; }
  CodedBlock encode_block(int block) const;

 private:
  std::vector<CodedPlanes> leaves_of(int block) const;
  void encode_level(int block, int level, std::vector<CodedPlanes>& rest, CodedBlock& out) const;
  NodeCode encode_cell(const BlockCell& cell, int block, int level, const std::vector<CodedPlanes>& rest,
                       CodedSymbols* symbols) const;
  double squared_error(const CodedPlanes& rest, const std::vector<float>& importance) const;

  const FieldShape& shape_;
  const FieldTextures& textures_;
  const FieldSetting& setting_;
  double price_, base_;  // the step, in codes, of luma of a level that makes one sample a node
  std::vector<LevelSteps> steps_;
};

// Samples in a full cell.
int samples_per_cell(const FieldShape& shape, int level);

}  // namespace vitrine
