// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/block_kernels.h"

#include <algorithm>
#include <cmath>

#include "formats/node_coding.h"

namespace vitrine {
namespace {

constexpr int kLanes = 8;

float sum_of(const float* lanes) {
  return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]));
}

}  // namespace

VITRINE_WIDE_VECTORS float block_energy(const float* source, int size) {
  float lanes[kLanes] = {};
  for (int y = 0; y < size; ++y, source += kTileSize) {
    for (int x = 0; x < size; x += kLanes) {
      for (int i = 0; i < kLanes; ++i) lanes[i] += source[x + i] * source[x + i];
    }
  }
  return sum_of(lanes);
}

VITRINE_WIDE_VECTORS float block_error(const float* source, const int16_t* prediction, int size) {
  float lanes[kLanes] = {};
  for (int y = 0; y < size; ++y, source += kTileSize, prediction += size) {
    for (int x = 0; x < size; x += kLanes) {
      for (int i = 0; i < kLanes; ++i) {
        const float e = source[x + i] - static_cast<float>(prediction[x + i]);
        lanes[i] += e * e;
      }
    }
  }
  return sum_of(lanes);
}

VITRINE_WIDE_VECTORS void block_residual(const float* source, const int16_t* prediction, int size, float* residual) {
  for (int y = 0; y < size; ++y, source += kTileSize, prediction += size, residual += size) {
    for (int x = 0; x < size; ++x) residual[x] = source[x] - static_cast<float>(prediction[x]);
  }
}

VITRINE_WIDE_VECTORS CoefficientStats coefficient_stats(const float* coefficients, int count) {
  float sums[kLanes] = {}, largest[kLanes] = {};
  for (int x = 0; x < count; x += kLanes) {
    for (int i = 0; i < kLanes; ++i) {
      const float c = coefficients[x + i], m = std::fabs(c);
      sums[i] += c * c;
      largest[i] = largest[i] < m ? m : largest[i];
    }
  }
  return {sum_of(sums), *std::max_element(largest, largest + kLanes)};
}

VITRINE_WIDE_VECTORS double row_error(const float* importance, const int16_t* y, const int16_t* co, const int16_t* cg,
                                      int count) {
  float lanes[kLanes] = {};
  const auto texel = [&](int i) {
    const float g = y[i] + 0.5f * cg[i], t = y[i] - 0.5f * cg[i], r = t + 0.5f * co[i], b = t - 0.5f * co[i];
    return importance[i] * (r * r + g * g + b * b);
  };
  int x = 0;
  for (; x + kLanes <= count; x += kLanes) {
    for (int i = 0; i < kLanes; ++i) lanes[i] += texel(x + i);
  }
  for (; x < count; ++x) lanes[0] += texel(x);
  return static_cast<double>(sum_of(lanes));
}

}  // namespace vitrine
