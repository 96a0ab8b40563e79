// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Scenes built by hand, with light that is known in closed form.
#pragma once

#include <glm/glm.hpp>

#include "host/scene/scene.h"

namespace vitrine::test {

// An empty scene: one node (index 0, the camera's) and a perspective camera at `eye` that looks at `target`.
Scene scene_with_camera(const glm::vec3& eye, const glm::vec3& target, float yfov);

int add_material(Scene& scene, const Material& material);
// Adds geometry as an object at the world's origin.
int add_object(Scene& scene, Geometry geometry, int material, const std::string& name);
int add_light(Scene& scene, Light light, const glm::vec3& position, const glm::vec3& direction);
void set_environment(Scene& scene, const glm::vec3& radiance);

// Two triangles: corners origin, origin + u, origin + u + v, origin + v; the front is on the side of cross(u, v).
Geometry make_quad(const glm::vec3& origin, const glm::vec3& u, const glm::vec3& v);
// A UV sphere whose front is outside, with smooth normals.
Geometry make_sphere(const glm::vec3& center, float radius, int rows = 48);
// The six faces of a box, fronts outside.
Geometry make_box(const glm::vec3& low, const glm::vec3& high);

// A purely diffuse material without the dielectric coat.
Material lambert(const glm::vec3& albedo);
Material lamp(const glm::vec3& radiance);
Material metal(const glm::vec3& color, float roughness);
Material clear_glass(float ior, float roughness, float thickness);

}  // namespace vitrine::test
