// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/quantize.h"

#include <algorithm>
#include <cmath>

#include "formats/node_syntax.h"
#include "host/encode/block_kernels.h"

namespace vitrine {
namespace {

constexpr int kMaxCoefficients = kTileSize * kTileSize;

// What one coefficient was decided to be and what it adds.
struct Decision {
  float zero_cost;          // its distortion if it is dropped
  float cost;               // distortion and bits as decided, in the middle of the block
  float significance_bits;  // the part that falls away if it is the last
};

float magnitude_bits(const BitCosts& costs, int plane, int diagonal, LevelTemplate t, int magnitude) {
  if (magnitude == 0) return 0;
  BitCounter counter{costs, 1};  // the sign
  code_magnitude(counter, plane, diagonal, t, magnitude);
  return counter.bits;
}

class PlaneQuantizer {
 public:
  PlaneQuantizer(const float* coefficients, int log2, int plane, uint16_t step, float weight, const BitCosts& costs)
      : coefficients_(coefficients),
        log2_(log2),
        plane_(plane),
        costs_(costs),
        scan_(scan_order(log2)),
        inverse_step_(kStepUnitsPerCode / static_cast<float>(step)),
        scale_(weight * static_cast<float>(step) * static_cast<float>(step) / (kStepUnitsPerCode * kStepUnitsPerCode)) {}

  // Scan index of the last coefficient that can be nonzero, or -1; sums what dropping everything costs.
  int find_end() {
    const int count = 1 << (2 * log2_);
    const CoefficientStats stats = coefficient_stats(coefficients_, count);
    all_zero_cost_ = stats.energy * inverse_step_ * inverse_step_ * scale_;
    if (stats.largest * inverse_step_ < 0.5f) return -1;
    for (int i = count - 1; i > 0; --i) {
      const ScanPosition at = scan_[static_cast<size_t>(i)];
      if (std::fabs(coefficients_[(at.y << log2_) + at.x]) * inverse_step_ >= 0.5f) return i;
    }
    return 0;
  }
  float all_zero_cost() const { return all_zero_cost_; }

  void decide(int i, CoefficientLevels& levels) {
    const ScanPosition at = scan_[static_cast<size_t>(i)];
    const float c = coefficients_[(at.y << log2_) + at.x], u = std::fabs(c) * inverse_step_;
    const LevelTemplate t = levels.around(at);
    const int diagonal = at.x + at.y, context = significance_context(log2_, plane_, diagonal, t.sum);
    const int nearest = std::min(static_cast<int>(u + 0.5f), kMaxCoefficientLevel);
    Decision best{scale_ * u * u, scale_ * u * u + costs_.of(context, false), costs_.of(context, false)};
    int level = 0;
    for (int m = nearest; m > 0 && m >= nearest - 1; --m) {
      const float e = u - static_cast<float>(m);
      const float cost = scale_ * e * e + costs_.of(context, true) + magnitude_bits(costs_, plane_, diagonal, t, m);
      if (cost < best.cost) best.cost = cost, best.significance_bits = costs_.of(context, true), level = m;
    }
    levels.at(at.x, at.y) = static_cast<int16_t>(c < 0 ? -level : level);
    decisions_[static_cast<size_t>(i)] = best;
  }

  // The best last coefficient at or before `end`, or -1 when nothing is best. `cost` is in and out: that of nothing.
  int best_last(int end, const CoefficientLevels& levels, float bits_if_coded, float& cost) const {
    float before = 0;
    float remaining_zero = 0;
    for (int i = 0; i <= end; ++i)
      before += decisions_[static_cast<size_t>(i)].cost, remaining_zero += decisions_[static_cast<size_t>(i)].zero_cost;
    float after = all_zero_cost_ - remaining_zero;
    int best = -1;
    for (int i = end; i >= 0; --i) {
      const Decision& d = decisions_[static_cast<size_t>(i)];
      before -= d.cost;
      const ScanPosition at = scan_[static_cast<size_t>(i)];
      if (levels.at(at.x, at.y) != 0) {
        BitCounter counter{costs_, bits_if_coded};
        code_last(counter, log2_, plane_, i);
        const float total = before + d.cost - d.significance_bits + after + counter.bits;
        if (total < cost) cost = total, best = i;
      }
      after += d.zero_cost;
    }
    return best;
  }

 private:
  const float* coefficients_;
  int log2_, plane_;
  const BitCosts& costs_;
  std::span<const ScanPosition> scan_;
  float inverse_step_, scale_, all_zero_cost_ = 0;
  std::array<Decision, kMaxCoefficients> decisions_;
};

}  // namespace

QuantizedPlane quantize_plane(const float* coefficients, int log2, int plane, uint16_t step, float weight, const BitCosts& costs,
                              float bits_if_coded, float bits_if_not, CoefficientLevels& levels) {
  PlaneQuantizer quantizer(coefficients, log2, plane, step, weight, costs);
  const int end = quantizer.find_end();
  QuantizedPlane result{quantizer.all_zero_cost() + bits_if_not, false};
  if (end < 0) return result;
  for (int i = end; i >= 0; --i) quantizer.decide(i, levels);
  const int last = quantizer.best_last(end, levels, bits_if_coded, result.cost);
  const auto scan = scan_order(log2);
  levels.nonzero_count = 0;
  for (int i = end; i >= 0; --i) {
    const ScanPosition at = scan[static_cast<size_t>(i)];
    if (i > last)
      levels.at(at.x, at.y) = 0;
    else if (levels.at(at.x, at.y) != 0)
      levels.nonzero[static_cast<size_t>(levels.nonzero_count++)] = at;
  }
  levels.last = std::max(last, 0);
  result.coded = last >= 0;
  return result;
}

}  // namespace vitrine
