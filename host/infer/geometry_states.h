// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Where the drawn objects stand on the screen.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/infer/fields.h"
#include "host/infer/inference.h"
#include "host/infer/test_renderer.h"
#include "host/scene/scene.h"

namespace vitrine {

GeometryState geometry_state_at(const Scene& scene, const Position& position, std::span<const DrawnObject> objects, float aspect);
GeometryState geometry_state_at(const Scene& scene, int64_t grid_sample, std::span<const DrawnObject> objects, float aspect);

// Distinct geometry states of a set of objects, and which samples see them.
struct GeometryStates {
  StateTable table;
  std::vector<GeometryState> states;
};
// Samples that agree on `geometry_axes`, and then those where everything stands at the very same place on the screen: an axis
// that moves only what is never in the picture makes no states. Likewise those of `between`, by themselves.
GeometryStates make_geometry_states(const Scene& scene, AxisMask geometry_axes, std::span<const DrawnObject> objects,
                                    float aspect, std::vector<BetweenSample> between = {});

// Whether the box around object `number` of the states meets the picture in any of them.
bool may_be_seen(const DrawnObject& object, size_t number, std::span<const GeometryState> states);

}  // namespace vitrine
