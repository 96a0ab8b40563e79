// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What must be resident and what must be decoded, per anchor cell of the whole space, summed over all fields. Each field is
// worked out on its own axes only and then spread over the others, so that the work grows with the fields' own grids.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/parameter_space.h"
#include "host/plan/anchors.h"
#include "host/plan/plan.h"

namespace vitrine {

// One step of the anchor: -1, 0 or +1 cell per axis.
using AnchorStep = std::array<int, kMaxAxes>;
int step_number(const AnchorStep& step, int axis_count);  // 0..3^axis_count - 1
AnchorStep step_from_number(int number, int axis_count);
int step_count(int axis_count);

// Decoded nodes are kept in slots of their size, so each size of texture has a worst cell of its own.
struct PoolDemand {
  int width = 0, height = 0;
  std::vector<uint64_t> resident_nodes;  // per cell, without the pinned ones
  uint64_t pinned_nodes = 0;

  uint64_t worst_bytes() const;
};

// The pinned tops (level 0 of every pyramid) are left out but in pinned_nodes; all-zero nodes cost nothing and are never kept.
struct Demand {
  std::vector<uint64_t> displayed_units;  // per cell: decoding all that it shows
  std::vector<uint64_t> entering_units;   // [cell][step]: nodes that become resident when the anchor steps; 0 off the space
  std::vector<PoolDemand> pools;
};

Demand find_demand(const AnchorLattice& anchors, const std::vector<PlannedField>& fields, int horizon);

}  // namespace vitrine
