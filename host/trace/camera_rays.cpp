// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/camera_rays.h"

namespace vitrine::trace {

CameraRays::CameraRays(const Camera& camera, const glm::mat4& world_from_camera, int width, int height)
    : perspective_(camera.perspective), world_from_camera_(world_from_camera), size_(width, height), near_(camera.near_distance) {
  const float half_height = perspective_ ? std::tan(0.5f * camera.yfov) : camera.ymag;
  scale_ = {half_height * size_.x / size_.y, half_height};
  const float half_pixel = half_height / size_.y;
  width_ = perspective_ ? half_pixel * near_ : half_pixel;
  spread_ = perspective_ ? half_pixel : 0.0f;
}

Ray CameraRays::ray(float x, float y) const {
  const glm::vec2 plane = scale_ * glm::vec2(2 * x / size_.x - 1, 1 - 2 * y / size_.y);
  const glm::vec3 local_origin = perspective_ ? glm::vec3(plane * near_, -near_) : glm::vec3(plane, -near_);
  const glm::vec3 local_direction = perspective_ ? glm::vec3(plane, -1) : glm::vec3(0, 0, -1);
  return {glm::vec3(world_from_camera_ * glm::vec4(local_origin, 1)),
          glm::normalize(glm::mat3(world_from_camera_) * local_direction),
          0,
          std::numeric_limits<float>::infinity(),
          width_,
          spread_};
}

}  // namespace vitrine::trace
