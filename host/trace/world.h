// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The scene as rays meet it: one Embree BVH per object, built once (anew for every pose where an axis deforms it), instanced
// where the pose puts it; hits, surface points and shadow rays. The backdrop (Object::follows_camera) is no geometry here: rays
// miss it.
//
// Single-sided materials that do not transmit are not met from behind, by any ray. Shadow rays see alpha as its mean, thin
// smooth panes as what they let through, and other glass as `through_glass` says.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "host/scene/deformation.h"
#include "host/scene/scene.h"
#include "host/trace/ray_log.h"
#include "host/trace/shading_material.h"

namespace vitrine::trace {

struct Ray {
  glm::vec3 origin, direction;  // unit
  float t_min = 0, t_max = std::numeric_limits<float>::infinity();
  // The cone that the ray stands for, by which textures are filtered (Akenine-Moller et al., "Texture Level of Detail Strategies
  // for Real-Time Ray Tracing", 2019): its diameter at the origin, and what that grows by per unit of distance.
  float width = 0, spread = 0;

  float width_at(float distance) const { return width + spread * distance; }
};

// Where a ray first meets a surface.
struct Hit {
  int object = -1, triangle = 0;
  float u = 0, v = 0;  // barycentric weights of the second and third corner
  float distance = 0;
};

// All about the point of a hit.
struct Surface {
  int object = 0, triangle = 0;
  const ShadingMaterial* material = nullptr;
  glm::vec3 position{0}, geometric{0, 0, 1}, shading{0, 0, 1};  // unit normals on the triangle's front
  glm::vec3 coat{0, 0, 1};                                      // the coat's normal
  SurfacePoint point;
  float distance = 0;  // along the ray
  float margin = 0;    // how far from it a ray may start without meeting it again
  float emission = 1;  // factor of the pose
  float cosine = 1;    // between the ray and the geometric normal, positive
  bool back = false;   // met from behind
};

// What shading reads of a vertex, in the world, in one half of a cache line. Normals are not of unit length.
struct alignas(32) ShadingVertex {
  glm::vec3 position, normal;
  glm::vec2 uv;  // of the first set
};

// What it reads of a triangle, as posed: all that does not depend on the point.
struct alignas(16) ShadingTriangle {
  std::array<uint32_t, 3> corner;
  int32_t material;            // index into World::materials()
  glm::vec3 normal;            // unit, on the front; 0 where the triangle has no area
  float margin;                // how far from it a ray may start without meeting it again
  std::array<glm::vec2, 2> density;  // squares of how fast u and v change with the way in the world, of both sets
};

// Emission in the picture's layers: the part that is the same from everywhere, as the mean over all views, and what a coat makes
// of it for the one view.
struct LayeredEmission {
  glm::vec3 diffuse{0}, view{0};
};

struct Shadow {
  glm::vec3 transmittance{1};
  bool through_glass = false;  // in a straight line through rough or solid glass
};

// One object as it is posed.
struct PosedObject {
  const Object* object = nullptr;
  const Geometry* geometry = nullptr;          // the object's own, or what the pose makes of it
  std::vector<ShadingVertex> vertices;         // of `geometry`, as posed
  std::vector<ShadingTriangle> triangles;
  const ShadingMaterial* materials = nullptr;  // all of the scene's; index -1 means the last
  size_t material_count = 0;
  glm::mat4 world_from_object{1};
  glm::mat3 normal_from_object{1};  // inverse transpose
  float orientation = 1;            // sign of the determinant
  float emission = 1;
  const Textures* textures = nullptr;

  const ShadingMaterial& material(size_t triangle) const {
    return materials[static_cast<size_t>(triangles[triangle].material)];
  }
  SurfacePoint point_at(int triangle, float u, float v) const;
};

class World {
 public:
  explicit World(const Scene& scene);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  void pose(const Position& position);

  bool intersect(const Ray& ray, Hit& hit) const;
  Surface surface_at(const Ray& ray, const Hit& hit) const;
  // Emission of a surface towards where it was met from, through its coat.
  glm::vec3 emission_of(const Surface& surface) const;
  // The same in two parts, of which it is the sum.
  LayeredEmission layered_emission_of(const Surface& surface) const;
  // What reaches ray.origin from distance ray.t_max. `through_glass`: whether light may go straight through rough or solid
  // glass (else it stops there); `absorption` is that of the medium around the origin.
  Shadow shadow(const Ray& ray, bool through_glass, const glm::vec3& absorption) const;

  // Queries go to `log` too, from now on; null: no more. For one thread.
  void log_rays(RayLog* log) { log_ = log; }
  RTCScene embree_scene() const { return root_; }

  const Scene& scene() const { return scene_; }
  const Textures& textures() const { return textures_; }
  const Pose& current_pose() const { return pose_; }
  const std::vector<PosedObject>& objects() const { return objects_; }
  const std::vector<ShadingMaterial>& materials() const { return materials_; }
  int backdrop() const { return backdrop_; }  // index into Scene::objects, or -1
  float radius() const { return radius_; }    // of a sphere that holds all geometry
  const glm::vec3& center() const { return center_; }

 private:
  void build_object(size_t index);
  void release_object(size_t index);
  void deform_object(size_t index);
  void prepare_shading(size_t index, const std::vector<int>& triangle_materials);
  glm::vec3 emission_below_coat(const Surface& surface) const;
  void apply_normal_maps(const glm::vec3& shading, const glm::vec3& barycentric, Surface& surface) const;

  const Scene& scene_;
  Textures textures_;
  Pose pose_;
  std::vector<ShadingMaterial> materials_;
  std::vector<PosedObject> objects_;
  std::vector<DeformedMesh> deformed_;   // parallel to objects_; empty where nothing is deformed
  std::vector<RTCScene> object_scenes_;  // null for the backdrop and empty objects
  std::vector<RTCGeometry> instances_;
  RTCDevice device_ = nullptr;
  RTCScene root_ = nullptr;
  RayLog* log_ = nullptr;
  int backdrop_ = -1;
  float radius_ = 1;
  glm::vec3 center_{0};
};

}  // namespace vitrine::trace
