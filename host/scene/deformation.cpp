// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/deformation.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_inverse.hpp>

#include "host/base/error.h"
#include "host/scene/geometry.h"
#include "host/scene/thin_solids.h"

namespace vitrine {
namespace {

void displace(std::vector<glm::vec3>& values, float weight, const std::vector<glm::vec3>& displacements) {
  const size_t count = std::min(values.size(), displacements.size());
  for (size_t i = 0; i < count; ++i) values[i] += weight * displacements[i];
}

void morph(const std::vector<MorphTarget>& targets, const std::vector<float>& weights, Geometry& g) {
  for (size_t t = 0; t < targets.size(); ++t) {
    if (weights[t] == 0) continue;
    displace(g.positions, weights[t], targets[t].positions);
    displace(g.normals, weights[t], targets[t].normals);
    const size_t tangents = std::min(g.tangents.size(), targets[t].tangents.size());
    for (size_t i = 0; i < tangents; ++i) g.tangents[i] += glm::vec4(weights[t] * targets[t].tangents[i], 0);
  }
}

// Sum of the joints' matrices of one vertex, weighted; weights are scaled to a sum of 1.
glm::mat4 skin_matrix(const SkinInfluence* influences, size_t count, const std::vector<glm::mat4>& world_from_bind) {
  glm::mat4 matrix(0);
  float sum = 0;
  for (size_t k = 0; k < count; ++k) {
    if (influences[k].weight == 0) continue;
    matrix += world_from_bind[influences[k].joint] * influences[k].weight;
    sum += influences[k].weight;
  }
  return sum > 0 ? matrix / sum : glm::mat4(1);
}

void skin(const MeshPrimitive& primitive, const std::vector<glm::mat4>& world_from_bind, Geometry& g) {
  if (primitive.influences.empty()) return;
  const size_t count = primitive.influences_per_vertex;
  for (size_t i = 0; i < g.positions.size(); ++i) {
    const glm::mat4 m = skin_matrix(&primitive.influences[count * i], count, world_from_bind);
    g.positions[i] = glm::vec3(m * glm::vec4(g.positions[i], 1));
    const glm::mat3 linear(m);
    const float determinant = glm::determinant(linear);
    if (!g.normals.empty() && std::abs(determinant) > 1e-20f) g.normals[i] = glm::inverseTranspose(linear) * g.normals[i];
    if (g.tangents.empty()) continue;
    const float handedness = determinant < 0 ? -g.tangents[i].w : g.tangents[i].w;  // a mirror turns the bitangent, too
    g.tangents[i] = glm::vec4(linear * glm::vec3(g.tangents[i]), handedness);
  }
}

void check_range(const MeshPrimitive& primitive, const Geometry& g) {
  constexpr float kFarthest = 1e12f;  // metres; squares of it are far from overflow
  for (const glm::vec3& p : g.positions)
    for (int c = 0; c < 3; ++c)
      if (!(std::abs(p[c]) < kFarthest))
        throw InputError(primitive.place, "a vertex lies farther than 1e12 metres away", "export the model anew or repair it");
}

// Tangents of unit length, in the surface, with handedness 1 or -1.
void repair_tangents(Geometry& g) {
  for (size_t i = 0; i < g.tangents.size(); ++i) {
    const glm::vec3 t = glm::vec3(g.tangents[i]) - g.normals[i] * glm::dot(g.normals[i], glm::vec3(g.tangents[i]));
    const float length = glm::length(t), w = g.tangents[i].w < 0 ? -1.0f : 1.0f;
    const glm::vec3 other = std::abs(g.normals[i].x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    const bool usable = length > 1e-12f && std::isfinite(length);
    g.tangents[i] = glm::vec4(usable ? t / length : glm::normalize(glm::cross(g.normals[i], other)), w);
  }
}

Geometry shape_of(const MeshPrimitive& primitive, const MeshPose& pose) {
  Geometry g = primitive.vertices;
  shape_primitive(primitive, pose, g);
  return g;
}

// glTF 2.0, appendix C.5, for one weight: a key holds in-tangents, values, out-tangents of `count` weights each; `width` is
// the distance to the next key.
float cubic_weight(const float* key, size_t count, size_t weight, float t, float width) {
  const float v0 = key[count + weight], out = key[2 * count + weight];
  const float in = key[3 * count + weight], v1 = key[4 * count + weight];
  const float t2 = t * t, t3 = t2 * t;
  return v0 * (2 * t3 - 3 * t2 + 1) + out * (width * (t3 - 2 * t2 + t)) + v1 * (3 * t2 - 2 * t3) + in * (width * (t3 - t2));
}

}  // namespace

void shape_primitive(const MeshPrimitive& primitive, const MeshPose& pose, Geometry& g) {
  morph(primitive.targets, pose.weights, g);
  skin(primitive, pose.world_from_bind, g);
  check_range(primitive, g);
  if (primitive.parts == PrimitiveParts::kPoints) make_octahedra(g);
  if (primitive.parts == PrimitiveParts::kLines) make_rods(g);
  drop_degenerate_triangles(g);
  if (g.indices.empty()) return;
  if (g.normals.empty())
    make_flat_normals(g);
  else
    repair_normals(g);
}

void add_tangents(const MeshPrimitive& primitive, Geometry& g) {
  if (!g.tangents.empty())
    repair_tangents(g);
  else if (primitive.tangent_texcoord >= 0)
    make_tangents(g, primitive.tangent_texcoord, primitive.tangent_transform);
}

void append_primitive(const MeshPrimitive& primitive, Geometry g, DeformedMesh& mesh) {
  g.triangle_materials.assign(g.indices.size() / 3, primitive.materials[0]);
  for (size_t v = 0; v < mesh.variant_materials.size(); ++v)
    mesh.variant_materials[v].insert(mesh.variant_materials[v].end(), g.triangle_materials.size(), primitive.materials[1 + v]);
  append_geometry(mesh.geometry, g);
}

MeshPose mesh_pose(const Scene& scene, const Pose& pose, int object) {
  const Deformation& deformation = *scene.objects[static_cast<size_t>(object)].deformation;
  const std::vector<float>& driven = pose.morph_weights[static_cast<size_t>(object)];
  MeshPose result{driven.empty() ? deformation.weights : driven, {}};
  for (const SkinJoint& joint : deformation.joints)
    result.world_from_bind.push_back(
        joint.node < 0 ? joint.node_from_bind : pose.world_from_node[static_cast<size_t>(joint.node)] * joint.node_from_bind);
  return result;
}

DeformedMesh deformed_mesh(const Scene& scene, const Pose& pose, int object) {
  const Object& source = scene.objects[static_cast<size_t>(object)];
  const MeshPose at = mesh_pose(scene, pose, object);
  DeformedMesh mesh;
  mesh.variant_materials.resize(source.variant_materials.size());
  for (const MeshPrimitive& primitive : source.deformation->primitives) {
    Geometry g = shape_of(primitive, at);
    if (g.indices.empty()) continue;
    add_tangents(primitive, g);
    append_primitive(primitive, std::move(g), mesh);
  }
  return mesh;
}

Geometry deformed_shape(const Scene& scene, const Pose& pose, int object) {
  const MeshPose at = mesh_pose(scene, pose, object);
  Geometry shape;
  for (const MeshPrimitive& primitive : scene.objects[static_cast<size_t>(object)].deformation->primitives)
    append_geometry(shape, shape_of(primitive, at));
  return shape;
}

size_t deformation_work(const Deformation& deformation) {
  size_t work = 0;
  for (const MeshPrimitive& primitive : deformation.primitives) {
    work += primitive.vertices.indices.size() + primitive.vertices.positions.size() + primitive.influences.size();
    for (const MorphTarget& target : primitive.targets)
      work += target.positions.size() + target.normals.size() + target.tangents.size();
  }
  return work;
}

std::vector<float> sample_weights(const WeightTrack& track, const Position& position) {
  const float given = position[static_cast<size_t>(track.axis)], p = given >= 0 ? std::min(given, 1.0f) : 0.0f;
  const bool cubic = track.interpolation == Interpolation::kCubicSpline;
  const size_t per_key = track.values.size() / track.positions.size(), count = cubic ? per_key / 3 : per_key;
  const auto after = std::upper_bound(track.positions.begin(), track.positions.end(), p);
  const size_t key = after == track.positions.begin() ? 0 : static_cast<size_t>(after - track.positions.begin()) - 1;
  const float* keys = &track.values[key * per_key];
  std::vector<float> weights(keys + (cubic ? count : 0), keys + (cubic ? 2 * count : count));
  const bool held = after == track.positions.begin() || after == track.positions.end();  // before the first, after the last key
  if (held || track.interpolation == Interpolation::kStep) return weights;
  const float width = *after - track.positions[key], t = (p - track.positions[key]) / width;
  for (size_t w = 0; w < count; ++w)
    weights[w] = cubic ? cubic_weight(keys, count, w, t, width) : weights[w] + (keys[per_key + w] - weights[w]) * t;
  return weights;
}

AxisMask deforming_axes(const Scene& scene, int object) {
  const Object& deformed = scene.objects[static_cast<size_t>(object)];
  if (!deformed.deformation) return 0;
  std::vector<bool> carries(scene.nodes.size(), false);  // nodes on the way from a joint to its root
  for (const SkinJoint& joint : deformed.deformation->joints)
    for (int n = joint.node; n >= 0 && !carries[static_cast<size_t>(n)]; n = scene.nodes[static_cast<size_t>(n)].parent)
      carries[static_cast<size_t>(n)] = true;
  AxisMask mask = 0;
  for (const RigTrack& track : scene.tracks)
    if (carries[track.node]) mask |= AxisMask{1} << track.axis;
  for (const WeightTrack& track : scene.weight_tracks)
    if (track.object == object) mask |= AxisMask{1} << track.axis;
  return mask;
}

}  // namespace vitrine
