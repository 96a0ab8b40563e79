// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The points of an object's surface that lie under a grid over its texture domain.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "host/infer/inference.h"

namespace vitrine {

struct SurfacePoint {
  int triangle = -1;      // of DrawnObject::indices; -1: no triangle covers it
  glm::vec3 weights{0};   // of its corners, sum 1
  glm::vec3 position{0};  // node space
};

// At the centres of a texture's texels, rows v = 0 first. Where triangles overlap, the first counts; those that a branch cut
// tears are left out: nothing of them is seen.
std::vector<SurfacePoint> surface_points(const DrawnObject& object, const Placement& placement);

// Where a picture of `size` pixels shows a point of node space, hidden or not: in pixels from the top left corner, pixel
// centres at halves; may lie outside. Nothing behind the camera.
std::optional<glm::vec2> pixel_of(const glm::mat4& clip_from_object, const glm::vec3& position, const glm::vec2& size);

}  // namespace vitrine
