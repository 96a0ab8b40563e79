// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Verification: an image played beside fresh, clean ground truth. A reference is traced in batches of independent seeds until
// its own noise, measured from the batches, lies well below the error that is measured, so that the figure says something
// about the image and not about the reference.
//
// PSNR: 8-bit sRGB, mean over R, G, B; of the whole picture, and of each object over the pixels that it covers by half or
// more.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/image.h"
#include "host/base/progress.h"
#include "host/frames/store.h"
#include "host/infer/inference.h"
#include "host/scene/scene.h"

namespace vitrine {

// 8-bit sRGB, rows top first.
struct Picture {
  int width = 0, height = 0;
  std::vector<uint8_t> rgb;
};

struct ObjectError {
  std::string name;
  double squared_error = 0;   // sum over its pixels and channels, 8-bit units
  int64_t values = 0;         // pixels times 3
};

// One position compared.
struct Comparison {
  Position position{};
  std::string kind;           // "at", "between", "off"
  Picture truth, played;
  std::optional<Picture> inferred;     // what uncoded textures would have shown
  std::vector<ObjectError> objects;    // played against truth
  std::vector<ObjectError> inferred_objects;
  double squared_error = 0, inferred_squared_error = 0;  // mean over values
  double noise = 0;           // expected mean squared error of `truth` itself
  int paths_per_pixel = 0;    // of the reference
};

struct VerifyOptions {
  int at = 3, between = 2, off = 2;    // how many positions of each kind
  double noise_margin_db = 6.5;        // how far a reference's noise must lie below the error
  int max_paths = 4096;                // per pixel; a reference that is still too noisy then is reported as it is
};

struct Verification {
  uint64_t bytes = 0, raw_bytes = 0;
  std::vector<Comparison> comparisons;
};

double psnr_db(double mean_squared_error);  // against 255; 99 dB for no error
double mean_squared_error(const Picture& a, const Picture& b);  // over all values, of pictures of one size

// Positions are chosen deterministically, spread over the grid. `inference` may be null (then nothing is inferred).
// `scene` must already agree with the image (apply_grid). Throws InputError.
Verification verify_image(const ImageView& image, const Scene& scene, const Store& store, const Inference* inference,
                          const VerifyOptions& options, Progress& progress);

}  // namespace vitrine
