// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What smoothing over the parameter axes (host/infer/axis_smoothing.h) takes from the samples and gives between them, in images
// of one size.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "host/base/progress.h"
#include "host/scene/scene.h"

namespace vitrine {

struct SmoothingRow {
  float smoothing = 0;
  uint64_t bytes = 0;
  double inferred_db = 0;                        // at samples, before coding
  double at_db = 0, between_db = 0, off_db = 0;  // as `vitrine verify` has them; over two references each
};

// Compiles `scene`, to its own storage, once for each strength. Frames, textures and references are kept in `work`.
std::vector<SmoothingRow> measure_smoothing(const Scene& scene, std::span<const float> strengths,
                                            const std::filesystem::path& work, Progress& progress);

}  // namespace vitrine
