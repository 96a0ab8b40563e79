// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What it costs to read a rendering matrix, in each of the ways that there are, and how right each is: against another way, and
// against what the device draws of random textures.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/gpu.h"
#include "host/infer/rendering_matrix.h"

namespace vitrine {

struct MatrixCost {
  std::string method;       // as MatrixReader names it
  int64_t renderings = 0;   // for one view
  double milliseconds = 0;  // likewise, wall clock
  float difference = 0;     // from what identifiers give, of a weight; infinite where they disagree about which samples show what
  float rendering_difference = 0;  // |A x - rendering|, texels in 0..1; in 8 bits throughout where the method is an 8-bit one
  float row_sum_error = 0;         // |row sum - 1|
};

// Reads the matrix of all `objects`, with textures of these `sizes`, in one view by every method, by bounding boxes only in
// pictures of at most 320 x 240 pixels, as they take minutes in larger ones; the largest of each difference. What readers keep
// from view to view is not timed. `options`: the filter and the picture's size. Throws InputError where a device refuses.
std::vector<MatrixCost> measure_matrix_costs(hal::Gpu& gpu, const InferenceOptions& options, std::span<const DrawnObject> objects,
                                             std::span<const TextureSize> sizes, const GeometryState& state);

}  // namespace vitrine
