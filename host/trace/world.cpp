// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/world.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstring>
#include <glm/gtc/matrix_inverse.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <stdexcept>

#include "host/trace/ray_filter.h"

namespace vitrine::trace {
namespace {

constexpr float kBlurred = 0.1f;  // spread of a ray that a wide lobe has scattered

glm::vec3 transform_point(const glm::mat4& m, const glm::vec3& p) {
  return p.x * glm::vec3(m[0]) + p.y * glm::vec3(m[1]) + p.z * glm::vec3(m[2]) + glm::vec3(m[3]);
}

float largest_coordinate(const glm::vec3& p) { return max_component(glm::abs(p)); }

// A buffer that Embree owns: its loads may run past the last vertex, which user memory would have to be padded for.
template <typename T>
void copy_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, const T* data, size_t bytes, size_t stride) {
  void* target = rtcSetNewGeometryBuffer(geometry, type, 0, format, stride, bytes / stride);
  if (!target) throw std::bad_alloc();
  std::memcpy(target, data, bytes);
}

RTCRay embree_ray(const Ray& ray) {
  return {ray.origin.x,
          ray.origin.y,
          ray.origin.z,
          ray.t_min,
          ray.direction.x,
          ray.direction.y,
          ray.direction.z,
          0,
          ray.t_max,
          0xffffffffu,
          0,
          0};
}

// A perturbed normal in the tangent frame of a surface (glTF 2.0, 3.9.3).
glm::vec3 normal_from_map(const Textures& textures, const TextureRef& map, float scale, const TexCoords& uv,
                          const glm::vec3& tangent, const glm::vec3& bitangent, const glm::vec3& normal) {
  glm::vec3 n = glm::vec3(textures.linear(map, {uv, {}})) * 2.0f - 1.0f;
  n.x *= scale;
  n.y *= scale;
  const glm::vec3 world = n.x * tangent + n.y * bitangent + std::max(n.z, 1e-3f) * normal;
  const float length = glm::length(world);
  return length > 0 ? world / length : normal;
}

}  // namespace

SurfacePoint PosedObject::point_at(int triangle, float u, float v) const {
  const Geometry& g = *geometry;
  const uint32_t* corner = &g.indices[3 * static_cast<size_t>(triangle)];
  const float w = 1 - u - v;
  SurfacePoint point;
  for (size_t set = 0; set < 2; ++set) {
    const auto& t = g.texcoords[set];
    if (!t.empty()) point.uv[set] = w * t[corner[0]] + u * t[corner[1]] + v * t[corner[2]];
  }
  if (!g.colors.empty()) point.color = w * g.colors[corner[0]] + u * g.colors[corner[1]] + v * g.colors[corner[2]];
  return point;
}

namespace {

// On one thread: the BVH, and with it which of two equally near triangles wins, must not depend on the machine. (A device with
// "threads=1" would instead hold all of TBB to one thread.)
void commit(RTCScene scene) {
  tbb::task_arena arena(1);
  arena.execute([scene] { rtcJoinCommitScene(scene); });  // rtcCommitScene would build in an arena of all threads
}

}  // namespace

World::World(const Scene& scene) : scene_(scene), textures_(scene), materials_(prepare_materials(scene)) {
  device_ = rtcNewDevice(nullptr);
  if (!device_) throw std::runtime_error("Embree does not start on this machine");
  root_ = rtcNewScene(device_);
  const size_t count = scene.objects.size();
  objects_.resize(count);
  deformed_.resize(count);
  object_scenes_.assign(count, nullptr);
  instances_.assign(count, nullptr);
  for (size_t i = 0; i < count; ++i) {
    objects_[i].object = &scene.objects[i];
    objects_[i].geometry = scene.objects[i].deformation ? &deformed_[i].geometry : &scene.objects[i].geometry;
    objects_[i].materials = materials_.data();
    objects_[i].material_count = materials_.size();
    objects_[i].textures = &textures_;
    if (scene.objects[i].follows_camera) {
      backdrop_ = static_cast<int>(i);
    } else if (!objects_[i].geometry->indices.empty()) {
      build_object(i);
    }
  }
}

World::~World() {
  for (size_t i = 0; i < objects_.size(); ++i) release_object(i);
  rtcReleaseScene(root_);
  rtcReleaseDevice(device_);
}

void World::prepare_shading(size_t index, const std::vector<int>& triangle_materials) {
  PosedObject& posed = objects_[index];
  const Geometry& g = *posed.geometry;
  posed.vertices.resize(g.positions.size());
  tbb::parallel_for(size_t{0}, g.positions.size(), [&](size_t v) {
    posed.vertices[v] = {transform_point(posed.world_from_object, g.positions[v]), posed.normal_from_object * g.normals[v],
                         g.texcoords[0].empty() ? glm::vec2(0) : g.texcoords[0][v]};
  });
  posed.triangles.resize(triangle_materials.size());
  const float origin = largest_coordinate(glm::vec3(posed.world_from_object[3]));
  tbb::parallel_for(size_t{0}, posed.triangles.size(), [&](size_t t) {
    ShadingTriangle& triangle = posed.triangles[t];
    for (size_t k = 0; k < 3; ++k) triangle.corner[k] = g.indices[3 * t + k];
    const auto corner = [&](size_t k) -> const glm::vec3& { return posed.vertices[triangle.corner[k]].position; };
    const glm::vec3 cross = posed.orientation * glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    const float length = glm::length(cross);
    triangle.normal = length > 0 ? cross / length : glm::vec3(0);
    triangle.material = triangle_materials[t] < 0 ? static_cast<int32_t>(posed.material_count) - 1 : triangle_materials[t];
    // Rounding of the transform to the world and back, which Embree makes of rays, and of the interpolation.
    triangle.margin =
        4e-6f *
        (std::max({largest_coordinate(corner(0)), largest_coordinate(corner(1)), largest_coordinate(corner(2))}) + 2 * origin);
    for (size_t set = 0; set < 2; ++set) {
      const auto& uv = g.texcoords[set];
      triangle.density[set] = glm::vec2(0);
      if (uv.empty() || !(length > 0)) continue;
      const glm::vec2 a = uv[triangle.corner[1]] - uv[triangle.corner[0]], b = uv[triangle.corner[2]] - uv[triangle.corner[0]];
      const glm::vec3 edge1 = corner(1) - corner(0), edge2 = corner(2) - corner(0);
      // The gradient of a linear function with differences a and b along the edges, turned by a right angle.
      const auto slope = [&](float along1, float along2) { return glm::length(along1 * edge2 - along2 * edge1) / length; };
      triangle.density[set] = {sqr(slope(a.x, b.x)), sqr(slope(a.y, b.y))};
    }
  });
}

void World::build_object(size_t index) {
  const Geometry& g = *objects_[index].geometry;
  RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  copy_buffer(mesh, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, g.positions.data(), g.positions.size() * sizeof(glm::vec3),
              sizeof(glm::vec3));
  copy_buffer(mesh, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, g.indices.data(), g.indices.size() * sizeof(uint32_t),
              3 * sizeof(uint32_t));
  rtcSetGeometryUserData(mesh, &objects_[index]);
  rtcSetGeometryIntersectFilterFunction(mesh, filter_intersection);
  rtcSetGeometryOccludedFilterFunction(mesh, filter_occlusion);
  rtcCommitGeometry(mesh);
  RTCScene object_scene = rtcNewScene(device_);
  rtcAttachGeometry(object_scene, mesh);
  rtcReleaseGeometry(mesh);
  commit(object_scene);
  object_scenes_[index] = object_scene;

  RTCGeometry instance = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(instance, object_scene);
  rtcSetGeometryTimeStepCount(instance, 1);
  rtcAttachGeometryByID(root_, instance, static_cast<unsigned>(index));
  instances_[index] = instance;
}

void World::release_object(size_t index) {
  if (!instances_[index]) return;
  rtcDetachGeometry(root_, static_cast<unsigned>(index));
  rtcReleaseGeometry(instances_[index]);
  rtcReleaseScene(object_scenes_[index]);
  instances_[index] = nullptr;
  object_scenes_[index] = nullptr;
}

// Triangles may come and go from pose to pose, so the BVH is built anew and not refitted.
void World::deform_object(size_t index) {
  release_object(index);
  deformed_[index] = deformed_mesh(scene_, pose_, static_cast<int>(index));
  if (!deformed_[index].geometry.indices.empty()) build_object(index);
}

void World::pose(const Position& position) {
  pose_ = pose_scene(scene_, position);
  for (size_t i = 0; i < objects_.size(); ++i) {
    PosedObject& posed = objects_[i];
    const Object& object = *posed.object;
    if (object.deformation) deform_object(i);
    const auto& variants = object.deformation ? deformed_[i].variant_materials : object.variant_materials;
    const bool varied = pose_.variant >= 0 && static_cast<size_t>(pose_.variant) < variants.size();
    posed.world_from_object = world_from_object(scene_, pose_, static_cast<int>(i));
    const glm::mat3 linear(posed.world_from_object);
    posed.orientation = glm::determinant(linear) < 0 ? -1.0f : 1.0f;
    posed.normal_from_object = glm::inverseTranspose(linear);
    posed.emission = i < pose_.object_emission.size() ? pose_.object_emission[i] : 1.0f;
    if (!instances_[i]) continue;
    prepare_shading(i, varied ? variants[static_cast<size_t>(pose_.variant)] : posed.geometry->triangle_materials);
    rtcSetGeometryTransform(instances_[i], 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, glm::value_ptr(posed.world_from_object));
    rtcCommitGeometry(instances_[i]);
  }
  commit(root_);
  RTCBounds bounds;
  rtcGetSceneBounds(root_, &bounds);
  const glm::vec3 low(bounds.lower_x, bounds.lower_y, bounds.lower_z), high(bounds.upper_x, bounds.upper_y, bounds.upper_z);
  const bool any = low.x <= high.x;
  center_ = any ? 0.5f * (low + high) : glm::vec3(0);
  radius_ = any ? std::max(0.5f * glm::length(high - low), 1e-6f) : 1.0f;
}

bool World::intersect(const Ray& ray, Hit& hit) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query;
  query.ray = embree_ray(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  if (log_) log_->add_intersection(query.ray);
  rtcIntersect1(root_, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit = {static_cast<int>(query.hit.instID[0]), static_cast<int>(query.hit.primID), query.hit.u, query.hit.v, query.ray.tfar};
  return true;
}

Surface World::surface_at(const Ray& ray, const Hit& hit) const {
  const PosedObject& posed = objects_[static_cast<size_t>(hit.object)];
  const Geometry& g = *posed.geometry;
  const ShadingTriangle& triangle = posed.triangles[static_cast<size_t>(hit.triangle)];
  const auto& corner = triangle.corner;
  const ShadingVertex &a = posed.vertices[corner[0]], &b = posed.vertices[corner[1]], &c = posed.vertices[corner[2]];
  const glm::vec3 barycentric(1 - hit.u - hit.v, hit.u, hit.v);
  const auto interpolate = [&](const auto& x, const auto& y, const auto& z) {
    return barycentric.x * x + barycentric.y * y + barycentric.z * z;
  };
  Surface s;
  s.object = hit.object;
  s.triangle = hit.triangle;
  s.distance = hit.distance;
  s.material = &posed.materials[static_cast<size_t>(triangle.material)];
  s.position = interpolate(a.position, b.position, c.position);
  s.margin = triangle.margin;
  s.geometric = is_black(triangle.normal) ? -ray.direction : triangle.normal;
  const float cosine = glm::dot(s.geometric, ray.direction);
  s.back = cosine > 0;
  s.cosine = std::fabs(cosine);
  s.emission = posed.emission;
  const glm::vec3 n = interpolate(a.normal, b.normal, c.normal);
  const float n_length = glm::length(n);
  s.shading = n_length > 0 ? n * (1 / n_length) : s.geometric;
  if (glm::dot(s.shading, s.geometric) < 0) s.shading = -s.shading;
  s.coat = s.shading;

  // What the cone covers in texture coordinates.
  s.point.blurred = ray.spread > kBlurred;
  const float covered = sqr(ray.width_at(hit.distance));
  s.point.uv[0] = interpolate(a.uv, b.uv, c.uv);
  s.point.footprint[0] = covered * triangle.density[0];
  if (const auto& t = g.texcoords[1]; !t.empty()) {
    s.point.uv[1] = interpolate(t[corner[0]], t[corner[1]], t[corner[2]]);
    s.point.footprint[1] = covered * triangle.density[1];
  }
  if (!g.colors.empty()) s.point.color = interpolate(g.colors[corner[0]], g.colors[corner[1]], g.colors[corner[2]]);
  if (s.material->normal_mapped) apply_normal_maps(s.shading, barycentric, s);
  return s;
}

void World::apply_normal_maps(const glm::vec3& shading, const glm::vec3& barycentric, Surface& s) const {
  const PosedObject& posed = objects_[static_cast<size_t>(s.object)];
  const Geometry& g = *posed.geometry;
  if (g.tangents.empty()) return;
  const uint32_t* corner = &g.indices[3 * static_cast<size_t>(s.triangle)];
  const glm::vec4 t =
      barycentric.x * g.tangents[corner[0]] + barycentric.y * g.tangents[corner[1]] + barycentric.z * g.tangents[corner[2]];
  glm::vec3 tangent = glm::mat3(posed.world_from_object) * glm::vec3(t);
  tangent -= glm::dot(tangent, shading) * shading;
  const float length = glm::length(tangent);
  if (!(length > 0)) return;
  tangent /= length;
  const float handedness = (g.tangents[corner[0]].w < 0 ? -1.0f : 1.0f) * posed.orientation;
  const glm::vec3 bitangent = glm::cross(shading, tangent) * handedness;
  const Material& m = *s.material->source;
  if (m.normal_texture) {
    s.shading = normal_from_map(textures_, m.normal_texture, m.normal_scale, s.point.uv, tangent, bitangent, shading);
  }
  if (m.clearcoat_normal_texture) {
    s.coat =
        normal_from_map(textures_, m.clearcoat_normal_texture, m.clearcoat_normal_scale, s.point.uv, tangent, bitangent, shading);
  }
}

glm::vec3 World::emission_below_coat(const Surface& surface) const {
  if (!surface.material->emits || surface.emission == 0) return glm::vec3(0);
  if (surface.back && !surface.material->source->double_sided) return glm::vec3(0);
  return surface.emission * emission_at(textures_, *surface.material, surface.point);
}

// Of the geometric normal, as lights that are sampled know no other.
glm::vec3 World::emission_of(const Surface& surface) const {
  const glm::vec3 emission = emission_below_coat(surface);
  if (!surface.material->coated || is_black(emission)) return emission;
  return emission * coat_share_at(textures_, *surface.material, surface.point, surface.cosine).seen;
}

LayeredEmission World::layered_emission_of(const Surface& surface) const {
  const glm::vec3 emission = emission_below_coat(surface);
  if (!surface.material->coated || is_black(emission)) return {emission, glm::vec3(0)};
  const CoatShare share = coat_share_at(textures_, *surface.material, surface.point, surface.cosine);
  return {emission * share.mean, emission * (share.seen - share.mean)};
}

Shadow World::shadow(const Ray& ray, bool through_glass, const glm::vec3& absorption) const {
  ShadowContext context(through_glass);
  RTCRay query = embree_ray(ray);
  if (log_) log_->add_shadow(query, through_glass);
  rtcOccluded1(root_, &context.embree, &query);
  if (query.tfar < 0) return {glm::vec3(0), false};
  return context.result(ray.t_max, absorption);
}

}  // namespace vitrine::trace
