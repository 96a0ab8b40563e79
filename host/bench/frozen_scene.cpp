// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/frozen_scene.h"

#include "host/base/error.h"
#include "host/scene/deformation.h"

namespace vitrine {
namespace {

void check_rigid(const Scene& scene) {
  for (size_t o = 0; o < scene.objects.size(); ++o)
    if (deforming_axes(scene, static_cast<int>(o)) != 0)
      throw InputError(scene.file.string(),
                       "an axis deforms object \"" + scene.objects[o].name + "\", but targets draw rigid meshes only",
                       "leave the axis out");
}

bool moves_between_samples(const Axis& axis) { return axis.shape.kind != AxisKind::kDiscrete && axis.shape.samples > 1; }

// Keeps of what is switched by an axis the value at a sample.
template <typename Emitter>
void keep_value(Emitter& emitter, const GridIndex& sample) {
  if (emitter.emission_axis < 0) return;
  const auto index = static_cast<size_t>(sample[static_cast<size_t>(emitter.emission_axis)]);
  emitter.emission_of_value = {emitter.emission_of_value[index]};
}

void keep_variant(Object& object, int variant) {
  if (variant < 0 || object.variant_materials.empty()) return;
  object.variant_materials = {std::vector<int>(object.variant_materials[static_cast<size_t>(variant)])};
}

}  // namespace

Position middle_position(const Scene& scene) {
  const ParameterSpace space = scene.space();
  GridIndex index{};
  for (size_t a = 0; a < scene.axes.size(); ++a) index[a] = (scene.axes[a].shape.samples - 1) / 2;
  return space.position_of(index);
}

std::optional<Position> half_step_on(const Scene& scene, const Position& sample) {
  const AxisMask camera = camera_axes(scene);
  Position position = sample;
  bool any = false;
  for (size_t a = 0; a < scene.axes.size(); ++a) {
    const Axis& axis = scene.axes[a];
    if (!(camera >> a & 1) || !moves_between_samples(axis)) continue;
    const int steps = axis.shape.kind == AxisKind::kPeriodic ? axis.shape.samples : axis.shape.samples - 1;
    position[a] += 0.5f / static_cast<float>(steps);
    any = true;
  }
  if (!any) return std::nullopt;
  return position;
}

Scene frozen_at(const Scene& scene, const Position& position) {
  check_rigid(scene);
  const Pose pose = pose_scene(scene, position);
  const GridIndex sample = scene.space().nearest_sample(position);
  Scene frozen = scene;
  frozen.tracks.clear();
  frozen.track_data.clear();
  frozen.weight_tracks.clear();
  for (size_t n = 0; n < frozen.nodes.size(); ++n) {
    frozen.nodes[n] = RigNode{};
    frozen.nodes[n].matrix = pose.world_from_node[n];
  }
  for (Object& object : frozen.objects) {
    keep_value(object, sample);
    keep_variant(object, pose.variant);
  }
  for (Light& light : frozen.lights) keep_value(light, sample);
  for (Axis& axis : frozen.axes) axis.shape = {AxisKind::kLinear, 1};
  return frozen;
}

}  // namespace vitrine
