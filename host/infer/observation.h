// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// From traced frames to the right side and the weights of the least-squares problem.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "host/infer/fields.h"
#include "host/infer/solver.h"
#include "host/trace/frame.h"

namespace vitrine {

// Rows exist where tracer and device agree that at least this much of a pixel shows the object.
inline constexpr float kMinCoverage = 1.0f / 16;

// From the weights themselves. `share`: Observation::share.
Observation make_observation(const FilteredMatrix& matrix, std::vector<float> weight, float share = 1);
// W = the smaller of the coverages of the device and of all `frames` of the state.
Observation make_observation(const FilteredMatrix& matrix, int object, std::span<const Frame* const> frames, float share = 1);

// Light beyond this many times display white is cut before textures are solved for: a pixel looks no brighter for it, but least
// squares would spend themselves on the lamp's own reflection and ring around it.
inline constexpr float kHeadroom = 1;

// The mean of the frames' layers over the matrix' window; 0 where a frame does not show the object. `white`: the radiance that
// the display shows as white.
std::vector<glm::vec3> layer_in_window(const PixelWindow& window, int object, Layer layer, std::span<const Frame* const> frames,
                                       float white);

}  // namespace vitrine
