// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The forward transform that belongs to reconstruct_residual (formats/node_coding.h), in float, orthonormal to within the
// rounding of the integer basis.
#pragma once

namespace vitrine {

// size x size values in, as many coefficients out, both row-major ([frequency in y][frequency in x]); log2 = 3, 4, 5.
void forward_transform(const float* values, int log2, float* coefficients);

}  // namespace vitrine
