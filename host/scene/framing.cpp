// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/framing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>

#include "host/scene/deformation.h"
#include "host/scene/shapes.h"

namespace vitrine {
namespace {

// Fine where it shows the environment, whose coordinates bend between its corners; one colour needs no more than a hull.
struct DomeGrid {
  int columns, rows;
};
DomeGrid dome_grid(const Scene& scene) { return scene.background_is_environment ? DomeGrid{48, 24} : DomeGrid{8, 4}; }

constexpr float kDepthRatio = 10000;              // far / near: what a 24-bit depth buffer bears
constexpr int64_t kMostPoses = 256;               // of which the motion is judged
constexpr double kMostDistances = 5e7;            // triangles times poses that are measured
constexpr size_t kMostDeformation = 200'000'000;  // deformation_work of all poses: a second or two
constexpr int64_t kFewestDeformedPoses = 8;

struct Box {
  glm::vec3 low{std::numeric_limits<float>::max()}, high{std::numeric_limits<float>::lowest()};
  void add(const glm::vec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  bool empty() const { return high.x < low.x; }
  std::array<glm::vec3, 8> corners() const {
    std::array<glm::vec3, 8> c;
    for (int i = 0; i < 8; ++i)
      c[static_cast<size_t>(i)] = {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z};
    return c;
  }
};

Box box_of(const Geometry& g) {
  Box box;
  for (const uint32_t i : g.indices) box.add(g.positions[i]);
  return box;
}

// Deforming a mesh takes its time at every pose.
int64_t most_poses(const Scene& scene) {
  size_t work = 1;
  for (const Object& object : scene.objects)
    if (object.deformation) work += deformation_work(*object.deformation);
  return std::clamp(static_cast<int64_t>(kMostDeformation / work), kFewestDeformedPoses, kMostPoses);
}

// Samples of the grid, thinned evenly per axis (the ends stay) until there are few enough.
std::vector<Position> sampled_positions(const Scene& scene) {
  ParameterSpace space = scene.space();
  const int64_t most = most_poses(scene);
  while (space.sample_count() > most) {
    int longest = 0;
    for (int a = 1; a < space.axis_count; ++a)
      if (space.axes[static_cast<size_t>(a)].samples > space.axes[static_cast<size_t>(longest)].samples) longest = a;
    int& samples = space.axes[static_cast<size_t>(longest)].samples;
    samples = (samples + 1) / 2;
  }
  std::vector<Position> positions;
  for (int64_t i = 0; i < space.sample_count(); ++i) positions.push_back(space.position_of(space.index_from_flat(i)));
  return positions;
}

// Squared distance of `p` to a triangle (Ericson, "Real-Time Collision Detection", section 5.1.5).
float distance2(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap), d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp), d5 = glm::dot(ab, cp),
              d6 = glm::dot(ac, cp);
  const auto to = [&](const glm::vec3& q) { return glm::dot(p - q, p - q); };
  if (d1 <= 0 && d2 <= 0) return to(a);
  if (d3 >= 0 && d4 <= d3) return to(b);
  if (d6 >= 0 && d5 <= d6) return to(c);
  const float vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return to(a + ab * (d1 / (d1 - d3)));
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return to(a + ac * (d2 / (d2 - d6)));
  if (va <= 0 && d4 >= d3 && d5 >= d6) return to(b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
  const float sum = va + vb + vc;
  return sum > 0 ? to(a + ab * (vb / sum) + ac * (vc / sum)) : to(a);
}

float distance_to_object(const glm::vec3& eye, const Geometry& g, const glm::mat4& world_from_object, float nearest) {
  for (size_t i = 0; i < g.indices.size(); i += 3) {
    const auto corner = [&](size_t k) { return glm::vec3(world_from_object * glm::vec4(g.positions[g.indices[i + k]], 1)); };
    nearest = std::min(nearest, std::sqrt(distance2(eye, corner(0), corner(1), corner(2))));
  }
  return nearest;
}

// The shapes of the objects at one pose, with their boxes: those of deformed objects made anew, of the others as they are.
class PosedShapes {
 public:
  explicit PosedShapes(const Scene& scene) : scene_(scene), deformed_(scene.objects.size()) {
    for (const Object& object : scene.objects) boxes_.push_back(box_of(object.geometry));
  }
  void pose(const Pose& pose) {
    for (size_t o = 0; o < deformed_.size(); ++o) {
      if (!scene_.objects[o].deformation) continue;
      deformed_[o] = deformed_shape(scene_, pose, static_cast<int>(o));
      boxes_[o] = box_of(deformed_[o]);
    }
  }
  const Geometry& shape(size_t object) const {
    return scene_.objects[object].deformation ? deformed_[object] : scene_.objects[object].geometry;
  }
  const Box& box(size_t object) const { return boxes_[object]; }

 private:
  const Scene& scene_;
  std::vector<Geometry> deformed_;
  std::vector<Box> boxes_;
};

struct DepthRange {
  float nearest = std::numeric_limits<float>::max(), farthest = 0;
};

DepthRange measure(const Scene& scene) {
  DepthRange range;
  PosedShapes shapes(scene);
  double triangles = 0;
  for (const Object& object : scene.objects) triangles += static_cast<double>(object.geometry.indices.size() / 3);
  const std::vector<Position> positions = sampled_positions(scene);
  const size_t step =
      static_cast<size_t>(std::ceil(std::max(1.0, triangles * static_cast<double>(positions.size()) / kMostDistances)));
  for (size_t k = 0; k < positions.size(); ++k) {
    const Pose pose = pose_scene(scene, positions[k]);
    const glm::vec3 eye(pose.world_from_camera[3]);
    shapes.pose(pose);
    for (size_t o = 0; o < scene.objects.size(); ++o) {
      if (shapes.box(o).empty()) continue;
      const glm::mat4 world = world_from_object(scene, pose, static_cast<int>(o));
      for (const glm::vec3& corner : shapes.box(o).corners())
        range.farthest = std::max(range.farthest, glm::distance(eye, glm::vec3(world * glm::vec4(corner, 1))));
      if (k % step == 0) range.nearest = distance_to_object(eye, shapes.shape(o), world, range.nearest);
    }
  }
  return range;
}

// The least depth along the view axis of a point in the picture, as a share of its distance; at most one half, which leaves
// room for the motion between samples.
float depth_share(const Scene& scene) {
  if (!scene.camera.perspective) return 0.5f;
  const float aspect = static_cast<float>(scene.settings.width) / static_cast<float>(scene.settings.height);
  const float tangent = std::tan(scene.camera.yfov / 2) * std::hypot(1.0f, aspect);
  return std::min(0.5f, 0.8f / std::hypot(1.0f, tangent));
}

}  // namespace

Sphere bounds_of(const Scene& scene) {
  Box all;
  PosedShapes shapes(scene);
  for (const Position& position : sampled_positions(scene)) {
    const Pose pose = pose_scene(scene, position);
    shapes.pose(pose);
    for (size_t o = 0; o < scene.objects.size(); ++o) {
      if (scene.objects[o].follows_camera || shapes.box(o).empty()) continue;
      const glm::mat4 world = world_from_object(scene, pose, static_cast<int>(o));
      for (const glm::vec3& corner : shapes.box(o).corners()) all.add(glm::vec3(world * glm::vec4(corner, 1)));
    }
  }
  if (all.empty()) return {};
  return {(all.low + all.high) * 0.5f, std::max(1e-6f, glm::distance(all.low, all.high) / 2)};
}

float fitting_distance(float radius, float yfov, float aspect, float margin) {
  const float vertical = yfov / 2, horizontal = std::atan(std::tan(vertical) * aspect);
  return radius * (1 + margin) / std::sin(std::min(vertical, horizontal));
}

int add_fitted_camera(Scene& scene, const Sphere& bounds) {
  constexpr float kAzimuth = 0.6f, kElevation = 0.35f;  // radians
  const float aspect = static_cast<float>(scene.settings.width) / static_cast<float>(scene.settings.height);
  RigNode node;
  node.rotation = glm::angleAxis(kAzimuth, glm::vec3(0, 1, 0)) * glm::angleAxis(-kElevation, glm::vec3(1, 0, 0));
  node.translation =
      bounds.center + node.rotation * glm::vec3(0, 0, fitting_distance(bounds.radius, scene.camera.yfov, aspect, 0.1f));
  scene.nodes.push_back(node);
  return static_cast<int>(scene.nodes.size()) - 1;
}

void fit_depth(Scene& scene) {
  const DepthRange range = measure(scene);
  const float reach = range.farthest > 0 ? range.farthest : 1.0f;  // nothing to see but the backdrop
  const DomeGrid grid = dome_grid(scene);
  const float dome = 1.05f * reach / dome_inner_radius(grid.columns, grid.rows);
  scene.camera.far_distance = dome / 0.98f;
  const float nearest = std::min(range.nearest, reach);
  scene.camera.near_distance = std::max(depth_share(scene) * nearest, scene.camera.far_distance / kDepthRatio);
}

void add_backdrop(Scene& scene) {
  Material material;
  material.name = "background";
  material.unlit = true;
  material.base_color = glm::vec4(scene.background_is_environment ? glm::vec3(1) : scene.background_color, 1);
  Object object;
  object.name = "background";
  object.follows_camera = true;
  object.node = static_cast<int>(scene.nodes.size());
  const DomeGrid grid = dome_grid(scene);
  object.geometry = make_dome(0.98f * scene.camera.far_distance, grid.columns, grid.rows);
  object.geometry.triangle_materials.assign(object.geometry.indices.size() / 3, static_cast<int>(scene.materials.size()));
  scene.nodes.emplace_back();
  scene.materials.push_back(material);
  scene.background_object = static_cast<int>(scene.objects.size());
  scene.objects.push_back(std::move(object));
}

}  // namespace vitrine
