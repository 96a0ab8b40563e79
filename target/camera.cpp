// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/camera.h"

#include <glm/geometric.hpp>

namespace vitrine {

glm::mat4 camera_from_world(const glm::mat4& world_from_node) {
  glm::mat4 world_from_camera = world_from_node;
  for (int axis = 0; axis < 3; ++axis) {
    const float length = glm::length(glm::vec3(world_from_node[axis]));
    if (length > 0) world_from_camera[axis] /= length;
  }
  return glm::inverse(world_from_camera);
}

}  // namespace vitrine
