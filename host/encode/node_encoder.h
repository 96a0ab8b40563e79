// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Encodes one node of the DCT coder: rate-distortion optimized choice of quadtree, prediction and coefficient levels, tile
// by tile, against the contexts as they are at that tile.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "formats/node_coding.h"

namespace vitrine {

struct NodeTask {
  int width = 0, height = 0;
  std::span<const int16_t> planes;  // 3 * width * height, as NodeDecoder writes them
  std::array<uint16_t, kNodePlanes> steps{1, 1, 1};
  std::array<float, kNodePlanes> weights{1, 1, 1};  // per plane: what a squared error of one code is worth, in bits
  std::span<const float> cell_weights;              // relative importance per 8 x 8 cell, row-major, rounded up; empty: all 1
  std::span<const uint8_t> contexts;                // initial states; empty: built-in
  bool thorough = false;                            // try every prediction (nodes that carry a whole picture)
};

// A symbol that was coded: context in the upper bits, value in the lowest.
using CodedSymbols = std::vector<uint16_t>;

struct NodeCode {
  std::vector<uint8_t> bytes;   // none: the all-zero node
  uint64_t units = 0;           // exactly what NodeDecoder will spend
  std::vector<int16_t> planes;  // exactly what NodeDecoder will write
};

// Holds scratch memory; use one per thread.
class NodeEncoder {
 public:
  NodeEncoder();
  ~NodeEncoder();
  // `symbols`, where given, gets the adaptive symbols appended.
  NodeCode encode(const NodeTask& task, CodedSymbols* symbols = nullptr);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vitrine
