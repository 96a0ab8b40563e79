// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Rate-distortion optimized quantization of one plane of one block.
#pragma once

#include "formats/node_coding.h"
#include "host/encode/bit_costs.h"

namespace vitrine {

struct QuantizedPlane {
  float cost = 0;      // in bits: weighted squared error / lambda + bits of the coefficients (flags apart)
  bool coded = false;  // false: all zero, `levels` cleared
};

// `coefficients`: size x size, in codes. `weight`: what a squared error of one code costs, in bits. Fills `levels`, which
// must be cleared. Decides each level in coding order against the contexts as they will be, then the last coefficient (the
// method of the H.265 reference encoder). `bits_if_coded`, `bits_if_not`: of the flag that says whether there are any.
QuantizedPlane quantize_plane(const float* coefficients, int log2, int plane, uint16_t step, float weight, const BitCosts& costs,
                              float bits_if_coded, float bits_if_not, CoefficientLevels& levels);

}  // namespace vitrine
