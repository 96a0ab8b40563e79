// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "host/scene/deformation.h"
#include "host/scene/scene.h"

namespace vitrine {
namespace {

template <typename Emitter>
float emission_of(const Emitter& emitter, const GridIndex& nearest) {
  if (emitter.emission_axis < 0) return 1;
  return emitter.emission_of_value[static_cast<size_t>(nearest[static_cast<size_t>(emitter.emission_axis)])];
}

// Nodes on the way from `node` to its root.
void mark_path(const Scene& scene, int node, std::vector<bool>& marked) {
  for (; node >= 0 && !marked[static_cast<size_t>(node)]; node = scene.nodes[static_cast<size_t>(node)].parent)
    marked[static_cast<size_t>(node)] = true;
}

AxisMask axes_moving(const Scene& scene, const std::vector<bool>& marked) {
  AxisMask mask = 0;
  for (const RigTrack& track : scene.tracks)
    if (marked[track.node]) mask |= AxisMask{1} << track.axis;
  return mask;
}

}  // namespace

ParameterSpace Scene::space() const {
  ParameterSpace space;
  space.axis_count = static_cast<int>(axes.size());
  for (size_t a = 0; a < axes.size(); ++a) space.axes[a] = axes[a].shape;
  return space;
}

Pose pose_scene(const Scene& scene, const Position& position) {
  const GridIndex nearest = scene.space().nearest_sample(position);
  Pose pose;
  pose.world_from_node.resize(scene.nodes.size());
  evaluate_rig(scene.rig(), position, pose.world_from_node);
  if (!scene.nodes.empty()) pose.world_from_camera = pose.world_from_node[static_cast<size_t>(scene.camera.node)];
  if (scene.variant_axis >= 0) pose.variant = nearest[static_cast<size_t>(scene.variant_axis)];
  for (const Object& object : scene.objects) pose.object_emission.push_back(emission_of(object, nearest));
  for (const Light& light : scene.lights) pose.light_emission.push_back(emission_of(light, nearest));
  pose.morph_weights.resize(scene.objects.size());
  for (const WeightTrack& track : scene.weight_tracks)
    pose.morph_weights[static_cast<size_t>(track.object)] = sample_weights(track, position);
  return pose;
}

glm::mat4 world_from_object(const Scene& scene, const Pose& pose, int object) {
  const Object& o = scene.objects[static_cast<size_t>(object)];
  if (o.follows_camera) return glm::translate(glm::mat4(1), glm::vec3(pose.world_from_camera[3]));
  return pose.world_from_node[static_cast<size_t>(o.node)];
}

int material_of(const Object& object, const Pose& pose, int triangle) {
  const size_t t = static_cast<size_t>(triangle);
  if (pose.variant < 0 || object.variant_materials.empty()) return object.geometry.triangle_materials[t];
  return object.variant_materials[static_cast<size_t>(pose.variant)][t];
}

AxisMask camera_axes(const Scene& scene) {
  std::vector<bool> marked(scene.nodes.size());
  mark_path(scene, scene.camera.node, marked);
  return axes_moving(scene, marked);
}

AxisMask geometry_axes(const Scene& scene) {
  std::vector<bool> marked(scene.nodes.size());
  mark_path(scene, scene.camera.node, marked);
  for (const Object& object : scene.objects) mark_path(scene, object.node, marked);
  AxisMask mask = axes_moving(scene, marked);
  for (size_t o = 0; o < scene.objects.size(); ++o) mask |= deforming_axes(scene, static_cast<int>(o));
  return mask;
}

}  // namespace vitrine
