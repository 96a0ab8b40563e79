// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/mat4x4.hpp>

namespace vitrine {

// The view matrix of a camera on a rig node: its rotation and position, without the scale of its ancestors (glTF 2.0, section
// 3.10: "with the scaling ignored").
glm::mat4 camera_from_world(const glm::mat4& world_from_node);

}  // namespace vitrine
