// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Rays of the glTF camera, starting on its near plane as the rasterizer's do.
#pragma once

#include "formats/rig.h"
#include "host/trace/world.h"

namespace vitrine::trace {

class CameraRays {
 public:
  CameraRays(const Camera& camera, const glm::mat4& world_from_camera, int width, int height);
  // Picture coordinates in pixels from the top left corner; pixel centres at halves.
  Ray ray(float x, float y) const;

 private:
  bool perspective_;
  glm::mat4 world_from_camera_;
  glm::vec2 scale_, size_;
  float near_;
  float width_, spread_;  // of the cone around a ray: half a pixel
};

}  // namespace vitrine::trace
