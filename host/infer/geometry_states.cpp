// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/geometry_states.h"

#include <glm/matrix.hpp>

namespace vitrine {

GeometryState geometry_state_at(const Scene& scene, int64_t grid_sample, std::span<const DrawnObject> objects, float aspect) {
  const ParameterSpace space = scene.space();
  const Pose pose = pose_scene(scene, space.position_of(space.index_from_flat(grid_sample)));
  const glm::mat4 clip_from_world = clip_from_camera(scene.camera, aspect) * glm::inverse(pose.world_from_camera);
  GeometryState state;
  for (const DrawnObject& object : objects) {
    const glm::mat4 world = world_from_object(scene, pose, object.object);
    state.clip_from_object.push_back(clip_from_world * world);
    state.mirrored.push_back(glm::determinant(glm::mat3(world)) < 0);
  }
  return state;
}

}  // namespace vitrine
