// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Axes: what each one drives becomes tracks of the rig, rows of variants or switches of emitters.
#pragma once

#include "host/scene/gltf.h"
#include "host/scene/scene.h"
#include "host/scene/scene_toml.h"

namespace vitrine {

// Moves the scene's nodes by the axes of `description`, adding nodes (orbit, lamp) and objects (lamp) where needed.
// `scene` already holds the model's nodes, objects and lights; `node_names` are parallel to its nodes and grow with them.
// Returns the rig node of an orbit's camera, -1 without an orbit; `orbit_yfov` (radians) is set where the orbit has one.
struct OrbitCamera {
  int node = -1;
  float yfov = 0;  // 0: not said
};
OrbitCamera apply_axes(const SceneDescription& description, const GltfModel& model, Scene& scene,
                       std::vector<std::string>& node_names);

// Rotation about +Y by degrees; an orbit at angle 0 stands on +Z of its target.
glm::quat rotation_about_y(float degrees);

}  // namespace vitrine
