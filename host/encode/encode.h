// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Coding of fields (Hakura 2001, chapter 4): blocks, adaptive pyramids over the parameter axes, the DCT coder, and
// storage by equal slopes.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "formats/block.h"
#include "host/base/progress.h"

namespace vitrine {

// One texture of a field as companded codes in Y, Co, Cg: 3 planes of width * height.
using CodedPlanes = std::vector<int16_t>;

struct FieldSource {
  ParameterSpace space;  // restricted to the field's axes
  int width = 0, height = 0;
  // Per texel, screen pixels per texel (may hold zeros: texels that are never seen), for each way in which blocks lie on the
  // mesh; and which of them each block has (as FieldShape numbers blocks; empty: all the first).
  std::vector<std::vector<float>> importance;
  std::vector<uint16_t> block_maps;
  AxisSizes block_size{}, stagger{};         // host/base/field_blocks.h
  double samples_shown = 1;                  // grid samples of the whole space that one texture of this field serves
  std::function<CodedPlanes(int64_t)> load;  // texture of a flat field sample; called from several threads
};

struct EncodedField {
  FieldShape shape;
  std::vector<uint16_t> level_steps;             // 3 per level: Y, Co, Cg, in 1/8 code
  std::vector<uint8_t> contexts;                 // initial states, kContextBytesPerLevel per level
  std::vector<uint8_t> nodes;                    // all coded nodes in node order
  std::vector<uint32_t> node_bytes, node_units;  // per node; both 0 for cells off the grid
  double squared_error = 0;  // sum over leaves and texels of importance * mean squared error of the R, G, B codes
  uint64_t bytes() const { return nodes.size() + contexts.size() + 8 * node_bytes.size(); }
};

// Which pyramids a field may get. All but the first are for comparison.
enum class PyramidKind {
  kBest,       // residuals and differences, as suits the field
  kResiduals,  // the adaptive Laplacian pyramid
  kIsotropic,  // the plain Laplacian pyramid: every level halves all axes
};

struct EncodeOptions {
  PyramidKind pyramid = PyramidKind::kBest;
  // Of all fields together (EncodedField::bytes): met from below, within 1 % where the signal has that much to say.
  uint64_t target_bytes = 0;
  // No target makes the base step finer than this (below): about one 8-bit level, an error
  // of 0.3 levels, which no display shows.
  double finest_quantizer = 4;
  // > 0: this base step instead of a target: in codes, for luma of a texel of importance 1 that one sample shows.
  double quantizer = 0;
};

// The result depends on the inputs alone, not on the number of threads. Throws InputError when the node tables alone are
// larger than the target, and what `load` and `progress` throw.
std::vector<EncodedField> encode_fields(const std::vector<FieldSource>& fields, const EncodeOptions& options, Progress& progress);

}  // namespace vitrine
