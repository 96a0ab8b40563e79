// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Whether storage is shared out by equal slopes (Hakura 2001, section 4.5): the curve of error over bytes of every field, and
// how steep it is where the coder stops.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "host/base/progress.h"
#include "host/encode/encode.h"

namespace vitrine {

// The prices of a bit that a curve is measured at, over the one that meets the storage, which is the middle one.
inline constexpr std::array<double, 5> kAllocationPrices = {0.25, 0.5, 1, 2, 4};
inline constexpr size_t kChosenPrice = 2;

struct AllocationPoint {
  double bytes = 0;          // EncodedField::bytes
  double squared_error = 0;  // of codes, summed over the pixels of all grid samples, times FieldSource::weight
};

using AllocationCurve = std::array<AllocationPoint, kAllocationPrices.size()>;  // at kAllocationPrices

// -dError / dBits at the chosen point, from the points next to it; NaN where these have the same bytes. A curve of
// D = c 2^(-a R) would give 1.08 times the price by that.
double slope_of(const AllocationCurve& curve);

struct FieldAllocation {
  std::string object, layer;
  AllocationCurve curve;
  const AllocationPoint& chosen() const { return curve[kChosenPrice]; }
};

struct Allocation {
  double price = 0;  // squared error per bit, the chosen one
  std::vector<FieldAllocation> fields;
  AllocationCurve all() const;  // sums over the fields
};

struct FieldLabel {
  std::string object, layer;
};

// Codes `fields` at the price that makes all of them take `bytes` (within 1 %, or as near as a few attempts come), and at its
// multiples. No constraint on objects. Every price gets its own pyramids, exponents and contexts: the curves are the whole
// coder's. `labels`: of the fields, in their order.
Allocation measure_allocation(const std::vector<FieldSource>& fields, const std::vector<FieldLabel>& labels, NodeCoder coder,
                              double bytes, Progress& progress);

// The curves as an SVG picture, both axes logarithmic: the chosen points, and through each a line of the slope that all
// fields together have. Names go into it as they are: escaped.
std::string plot_of(const Allocation& allocation);

}  // namespace vitrine
