// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What it costs to read a rendering matrix, in each of the two ways, and whether both read the same.
#pragma once

#include <cstdint>

#include "hal/gpu.h"
#include "host/infer/rendering_matrix.h"

namespace vitrine {

struct ReaderCost {
  int64_t renderings = 0;   // for one view
  double milliseconds = 0;  // likewise, wall clock
};

struct MatrixCosts {
  ReaderCost identifiers, coordinates;
  float largest_difference = 0;  // of two weights; infinite where they disagree about which samples show what
};

// Reads the matrix of all `objects` (texture sizes final) in one view twice and times the second reading, as what readers keep
// from view to view is made by the first. `options`: the filter and the picture's size. Throws InputError where a device refuses.
MatrixCosts measure_matrix_costs(hal::Gpu& gpu, const InferenceOptions& options, std::span<const DrawnObject> objects,
                                 std::span<const TextureSize> sizes, const GeometryState& state);

}  // namespace vitrine
