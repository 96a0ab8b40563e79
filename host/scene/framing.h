// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What the camera needs to know of the scene's size: bounds over all axes, near and far plane, the backdrop's dome, a
// camera where nobody gave one.
#pragma once

#include "host/scene/scene.h"

namespace vitrine {

struct Sphere {
  glm::vec3 center{0};
  float radius = 1;
};

// A sphere around all objects but the backdrop, over the motion of all axes. Unit sphere where there are none.
Sphere bounds_of(const Scene& scene);

// Distance at which a sphere fits the picture with `margin` (0.1: ten per cent) around it.
float fitting_distance(float radius, float yfov, float aspect, float margin);

// Appends a node with a camera that sees all of `bounds`, from the front, a little from the right and above.
int add_fitted_camera(Scene& scene, const Sphere& bounds);

// Sets camera.near_distance and far_distance so that every object lies between them at every sample of the axes, the
// dome (of radius 0.98 far) beyond all of them. far / near <= 10000. Call after the camera is placed.
void fit_depth(Scene& scene);

// Appends the backdrop "background", a dome of 48 x 24 quads that fits the depth range.
void add_backdrop(Scene& scene);

}  // namespace vitrine
