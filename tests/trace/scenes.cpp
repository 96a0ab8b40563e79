// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "tests/trace/scenes.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

namespace vitrine::test {
namespace {

RigNode node_at(const glm::vec3& position, const glm::vec3& direction) {
  const glm::vec3 up = std::fabs(direction.y) > 0.99f ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
  RigNode node;
  node.translation = position;
  node.rotation = glm::quatLookAt(glm::normalize(direction), up);  // -Z along the direction
  return node;
}

void add_face(Geometry& g, const glm::vec3& origin, const glm::vec3& u, const glm::vec3& v) {
  const auto base = static_cast<uint32_t>(g.positions.size());
  const glm::vec3 n = glm::normalize(glm::cross(u, v));
  for (const glm::vec3& p : {origin, origin + u, origin + u + v, origin + v}) {
    g.positions.push_back(p);
    g.normals.push_back(n);
  }
  const glm::vec2 uv[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  g.texcoords[0].insert(g.texcoords[0].end(), std::begin(uv), std::end(uv));
  for (const uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) g.indices.push_back(base + i);
}

}  // namespace

Scene scene_with_camera(const glm::vec3& eye, const glm::vec3& target, float yfov) {
  Scene scene;
  scene.nodes.push_back(node_at(eye, target - eye));
  scene.camera.node = 0;
  scene.camera.yfov = yfov;
  scene.camera.near_distance = 1e-3f;
  return scene;
}

int add_material(Scene& scene, const Material& material) {
  scene.materials.push_back(material);
  return static_cast<int>(scene.materials.size()) - 1;
}

int add_object(Scene& scene, Geometry geometry, int material, const std::string& name) {
  Object object;
  object.name = name;
  object.node = static_cast<int>(scene.nodes.size());
  scene.nodes.emplace_back();
  geometry.triangle_materials.assign(geometry.indices.size() / 3, material);
  object.geometry = std::move(geometry);
  scene.objects.push_back(std::move(object));
  return static_cast<int>(scene.objects.size()) - 1;
}

int add_light(Scene& scene, Light light, const glm::vec3& position, const glm::vec3& direction) {
  light.node = static_cast<int>(scene.nodes.size());
  scene.nodes.push_back(node_at(position, direction));
  scene.lights.push_back(light);
  return static_cast<int>(scene.lights.size()) - 1;
}

void set_environment(Scene& scene, const glm::vec3& radiance) {
  scene.environment.width = scene.environment.height = 1;
  scene.environment.radiance = {radiance};
}

Geometry make_quad(const glm::vec3& origin, const glm::vec3& u, const glm::vec3& v) {
  Geometry g;
  add_face(g, origin, u, v);
  return g;
}

Geometry make_sphere(const glm::vec3& center, float radius, int rows) {
  Geometry g;
  const int columns = 2 * rows;
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= columns; ++c) {
      const float theta = 3.14159265f * static_cast<float>(r) / static_cast<float>(rows);
      const float phi = 2 * 3.14159265f * static_cast<float>(c) / static_cast<float>(columns);
      const glm::vec3 n(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
      g.positions.push_back(center + radius * n);
      g.normals.push_back(n);
    }
  }
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const auto a = static_cast<uint32_t>(r * (columns + 1) + c), b = a + static_cast<uint32_t>(columns) + 1;
      if (r > 0) g.indices.insert(g.indices.end(), {a, b, a + 1});
      if (r < rows - 1) g.indices.insert(g.indices.end(), {a + 1, b, b + 1});
    }
  }
  return g;
}

Geometry make_box(const glm::vec3& a, const glm::vec3& b) {
  Geometry g;
  const glm::vec3 x(b.x - a.x, 0, 0), y(0, b.y - a.y, 0), z(0, 0, b.z - a.z);
  add_face(g, a + z, x, y);
  add_face(g, a, y, x);
  add_face(g, a + y, z, x);
  add_face(g, a, x, z);
  add_face(g, a + x, y, z);
  add_face(g, a, z, y);
  return g;
}

Material lambert(const glm::vec3& albedo) {
  Material m;
  m.base_color = glm::vec4(albedo, 1);
  m.metallic = 0;
  m.specular = 0;
  return m;
}

Material lamp(const glm::vec3& radiance) {
  Material m = lambert(glm::vec3(0));
  m.emissive = radiance;
  return m;
}

Material metal(const glm::vec3& color, float roughness) {
  Material m;
  m.base_color = glm::vec4(color, 1);
  m.roughness = roughness;
  return m;
}

Material clear_glass(float ior, float roughness, float thickness) {
  Material m;
  m.metallic = 0;
  m.roughness = roughness;
  m.transmission = 1;
  m.ior = ior;
  m.thickness = thickness;
  return m;
}

}  // namespace vitrine::test
