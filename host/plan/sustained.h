// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The least number of units per frame that keeps up with straight motion at top speed.
#pragma once

#include <cstdint>
#include <span>

#include "host/plan/anchors.h"
#include "host/plan/demand.h"

namespace vitrine {

// The least U >= `at_least` such that in any k successive frames at most U (k + horizon) enter. `entering`: units per frame.
uint64_t least_sustained_units(std::span<const uint64_t> entering, int horizon, uint64_t at_least);

// The same over all straight paths: every axis alone and every combination of axes in either direction, each moving at its own
// greatest speed, all stepping in the first frame, from every cell of the border where the path begins. Paths whose axes are
// all periodic go round twice, and must also be sustained for ever.
uint64_t worst_sustained_units(const AnchorLattice& anchors, const Demand& demand, int horizon);

}  // namespace vitrine
