// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Embree calls these for every candidate hit of an object: which hits count, and what shadow rays lose on their way.
#pragma once

#include <embree3/rtcore.h>

#include "host/trace/world.h"

namespace vitrine::trace {

// User data of a geometry is its PosedObject. Both expect single rays.
void filter_intersection(const RTCFilterFunctionNArguments* arguments);
void filter_occlusion(const RTCFilterFunctionNArguments* arguments);

// A shadow ray's context. Hits come in any order, so absorption in solids is gathered as a signed sum of distances: a ray
// that enters at t0 and leaves at t1 adds t1 and subtracts t0.
struct ShadowContext {
  RTCIntersectContext embree;  // first: Embree hands it to the filter
  glm::vec3 transmittance{1};
  glm::vec3 depth{0};   // sum of absorption * distance, + where a solid is left, - where it is entered
  glm::vec3 inside{0};  // sum of absorption of solids entered but not left
  bool may_cross_glass, crossed_glass = false;

  explicit ShadowContext(bool through_glass) : may_cross_glass(through_glass) { rtcInitIntersectContext(&embree); }
  // `length` of the ray; `absorption` around its origin.
  Shadow result(float length, const glm::vec3& absorption) const;
};

}  // namespace vitrine::trace
