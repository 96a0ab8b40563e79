// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What texture inference costs beside the tracing of the frames it starts from (Hakura 2001, section 3.6, gives a share of 4 %),
// how it grows with views and pixels, and what memory it takes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host/base/progress.h"
#include "host/infer/inference.h"
#include "host/scene/scene.h"
#include "host/trace/tracer.h"

namespace vitrine {

// Processor seconds of inferring a scene's grid.
struct InferenceSeconds {
  double survey = 0;         // of light, texture domains and sizes
  double choose_reader = 0;  // both readers of rendering matrices once, side by side: whatever the number of views
  double read_matrices = 0;
  double solve = 0;  // with loading frames and storing textures
  double total() const { return survey + choose_reader + read_matrices + solve; }
};

struct InferenceCostRow {
  int64_t samples = 0;
  int width = 0, height = 0;
  InferenceSeconds seconds;
  int64_t texels = 0;  // of the finest levels of all objects
};

struct InferenceCost {
  double trace_seconds = 0;  // of one frame as compiled; 0: not traced
  InferenceCostRow sample;   // inferred from that frame
  std::vector<InferenceCostRow> by_samples, by_pixels;
  double samples_exponent = 0, pixels_exponent = 0;  // of cost over size, fitted by least squares of logarithms
  std::vector<InferenceCostRow> whole;               // the whole grid, where asked for
  int64_t peak_bytes = 0;                            // of the process, at the end
};

struct InferenceCostOptions {
  int supersampling = 2;
  bool trace = true;        // the frame as compiled; otherwise the sample is inferred from a frame of few paths like the rest
  bool scaling = true;      // rows over samples and pixels
  bool whole_grid = false;  // also infer all samples
};

// The middle sample of all axes for one; for several as many along the first axis, from end to end. `folder`: frames that it
// holds are not traced again, textures are inferred anew each time.
InferenceCost measure_inference_cost(const Scene& scene, const TraceOptions& as_compiled, const InferenceCostOptions& options,
                                     const std::filesystem::path& folder, Progress& progress);

// Cost over samples and over pixels as an SVG picture, both axes logarithmic.
std::string plot_of(const InferenceCost& cost);

}  // namespace vitrine
