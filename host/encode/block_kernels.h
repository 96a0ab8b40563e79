// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The inner loops of the block search, compiled also for wider vectors where the machine has them. Sums go through eight
// partial sums in a fixed order, so every machine gets the same bits.
#pragma once

#include <cstdint>

#if defined(__x86_64__) && defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__clang__)
#define VITRINE_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define VITRINE_WIDE_VECTORS
#endif

namespace vitrine {

// `source`: rows of kTileSize values, of which `size` columns and rows count; `prediction`: rows of `size`.
float block_energy(const float* source, int size);
float block_error(const float* source, const int16_t* prediction, int size);
void block_residual(const float* source, const int16_t* prediction, int size, float* residual);

struct CoefficientStats {
  float energy = 0;   // sum of squares
  float largest = 0;  // magnitude
};
// `count`: a multiple of 8.
CoefficientStats coefficient_stats(const float* coefficients, int count);

// Sum of importance * (eR^2 + eG^2 + eB^2) over a row of texels of three planes.
double row_error(const float* importance, const int16_t* y, const int16_t* co, const int16_t* cg, int count);

}  // namespace vitrine
