// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Deadlines. A node is needed at the positions of a box: those where a shown sample lies in its cell. A hand moves along axis
// i by at most max_speed_i samples a frame, along all axes at once, so from a position x the box is at least
//
//   D = max over axes of ceil(distance_i(x, box) / max_speed_i)
//
// frames away. D falls by at most 1 a frame, whatever the hand does: a deadline never moves closer as time goes by.
#pragma once

#include <array>
#include <cstdint>

#include "formats/block.h"
#include "formats/parameter_space.h"

namespace vitrine {

inline constexpr uint32_t kNever = 0xffffffffu;  // no legal motion leads there

// How far the hand may go, and how far a sample is shown around its own place.
struct Motion {
  std::array<float, kMaxAxes> max_speed{};  // samples per frame; 0 for discrete axes: they move by jumps only
  bool interpolate = false;                 // shown up to one sample away, else half a sample
  uint32_t horizon = 0;                     // frames
};

// Frames until some sample of [first, last] on an axis of `shape` can be shown, from coordinate `x` (samples).
uint32_t frames_along(const AxisShape& shape, float max_speed, bool interpolate, float x, int first, int last);

// D of a node of a field, x as sample coordinates of the field's own space.
uint32_t frames_until(const FieldShape& shape, const Motion& motion, const std::array<float, kMaxAxes>& x, int node);

// Sample coordinates of a position; an axis where only samples are shown (discrete) counts from the nearest one.
std::array<float, kMaxAxes> coordinates_of(const ParameterSpace& space, const Position& position);

// Whether a hand cannot have gone from one to the other in one frame.
bool is_jump(const ParameterSpace& space, const Motion& motion, const std::array<float, kMaxAxes>& from,
             const std::array<float, kMaxAxes>& to);

// ---- what is fetched ahead ----
//
// While the shown samples are the same the wanted ones are too: those within samples_ahead of the shown ones. So a node that
// enters has at least `horizon` frames until it is shown (host/plan proves the budget for exactly this set).

struct SampleRun {
  int first = 0, last = 0;  // of a periodic axis: not wrapped
};
SampleRun shown_samples(const AxisShape& shape, bool interpolate, float x);
int samples_ahead(const AxisShape& shape, float max_speed, uint32_t horizon);
// Whether [first, last] holds a sample of the run or one that is a turn away from it.
bool meets(const AxisShape& shape, const SampleRun& run, int first, int last);

}  // namespace vitrine
