// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The choice of a field's pyramid (the adaptive subdivision of Hakura 2001, section 4.3): which cells each level has, and
// whether it holds residuals or differences. All pyramids are compared, not only those that a greedy choice would meet: the
// details of nested levels are orthogonal, so a pyramid's cost is the sum of its steps' costs, each estimated once from
// transformed tiles, and the best pyramid is a shortest path.
#pragma once

#include "formats/block.h"
#include "host/encode/field_coder.h"

namespace vitrine {

struct ShapeChoice {
  PyramidShape pyramid;
  double bits = 0;  // estimate for all of the textures' nodes, node tables apart
};

// `shape`: everything but the pyramid. `price`: squared error per bit. `table_bits`: what a node costs beside its code.
// `work`: coefficients compared at most.
ShapeChoice choose_pyramid(const FieldShape& shape, const FieldTextures& textures, PyramidKind kind, double price,
                           double table_bits, int64_t work = 40'000'000);

}  // namespace vitrine
