// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What the nodes of one level of a field cost to decode, summed over boxes of nodes in constant time (a summed-area table).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/block.h"
#include "host/encode/encode.h"
#include "host/plan/intervals.h"

namespace vitrine {

// Per axis which rows of a level's lattice of nodes.
using NodeRows = std::array<IntervalSet, kMaxAxes>;

struct NodeSum {
  uint64_t units = 0;
  uint64_t coded = 0;  // nodes that have bytes: all-zero ones take no room and no time
};

class LevelCosts {
 public:
  LevelCosts(const EncodedField& field, int level);

  // The rows of nodes that hold any of these samples (of the field's own grid).
  IntervalSet rows_of(int axis, const IntervalSet& samples) const;
  // Over all nodes whose row is in the set on every axis; and over all of the level.
  NodeSum sum(const NodeRows& rows) const;
  NodeSum sum() const { return prefix_.back(); }

 private:
  void fill_prefix(const EncodedField& field, int level);
  NodeSum prefix_sum(const NodeRows& rows, int axis, size_t index) const;

  int axis_count_ = 0;
  std::array<int, kMaxAxes> stagger_{}, cell_{}, first_row_{}, rows_{};
  std::array<size_t, kMaxAxes> stride_{};  // of prefix_, which has rows + 1 entries an axis
  std::vector<NodeSum> prefix_;
};

}  // namespace vitrine
