// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The inner loops of decoding, for the vectors that the machine has (Highway chooses when the program runs). Integers only: all
// give what predict_block, reconstruct_residual and store_block of formats/node_coding.h say.
#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/node_coding.h"

namespace vitrine {

// Writes the prediction of a whole block, rows `stride` apart. Not for Prediction::kZero: that is what is there already.
void predict_texels(Prediction mode, const BlockBorder& border, int log2, int16_t* out, ptrdiff_t stride);

// Inverts dequantized coefficients, as invert_transform takes them, and adds them to a whole block, rows `stride` apart, which
// holds its prediction; clamps.
void add_residual(const int16_t* coefficients, CoefficientExtent extent, int log2, int16_t* out, ptrdiff_t stride);

}  // namespace vitrine
