// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What noise costs, and what is left of it: frames traced twice with different seeds, textures inferred from either, and the
// difference. All of it in decibels between the two (PSNR of sRGB codes), so that no clean reference is needed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/base/progress.h"
#include "host/frames/store.h"
#include "host/scene/scene.h"
#include "host/trace/tracer.h"

namespace vitrine {

// One layer of one object. The noise of a layer counts as it shows in the picture, at the radiance of all layers together.
struct LayerCost {
  std::string object, layer;
  double estimated_db = 0;  // by the tracer, the mean over frames of what it expects to be left in textures
  double frame_db = 0;      // in the frames
  // In pictures drawn with this layer's inferred textures alone, over the pixels that the object covers by half or more.
  // Nothing where none were inferred.
  std::optional<double> inferred_db;
};

// One object in pictures drawn with the inferred textures, over the pixels that it covers by half or more.
struct DrawnCost {
  std::string object;
  double db = 0;
};

struct NoiseCost {
  double rays_per_pixel = 0;      // camera rays, mean over frames
  double seconds = 0;             // processor time for one frame
  std::vector<LayerCost> layers;  // ascending objects
  std::vector<DrawnCost> drawn;   // ascending objects; empty where nothing was inferred
  double worst_db = 0;            // of `drawn`
  double picture_db = 0;          // of whole drawn pictures
};

// Traces all grid samples of the scene with `options` and two seeds, and with `infer` solves their textures, in `store`.
NoiseCost measure_noise(const Scene& scene, const TraceOptions& options, bool infer, const Store& store, Progress& progress);

}  // namespace vitrine
