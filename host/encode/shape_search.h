// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The choice of a field's pyramid (the adaptive subdivision of Hakura 2001, section 4.3): which cells each level has. All
// chains of up to kMaxChain levels are compared. The details of nested levels are orthogonal, so a chain's cost is the sum of
// its steps' costs, each estimated once from transformed tiles, and the best chain is a shortest path.
#pragma once

#include "formats/block.h"
#include "host/encode/field_coder.h"

namespace vitrine {

inline constexpr int kMaxChain = 4;

struct ShapeChoice {
  PyramidShape pyramid;
  double bits = 0;  // estimate for all of the textures' nodes, node tables apart
};

// `shape`: everything but the pyramid. `price`: squared error per bit. `table_bits`: what a node costs beside its code.
// `work`: coefficients compared at most.
ShapeChoice choose_pyramid(const FieldShape& shape, const FieldTextures& textures, double price, double table_bits,
                           int64_t work = 40'000'000);

}  // namespace vitrine
