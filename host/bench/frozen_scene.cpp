// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/frozen_scene.h"

#include <algorithm>

#include "host/base/error.h"
#include "host/infer/fields.h"
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

namespace {

// Positions p of an axis become scale * (p - first).
struct AxisPart {
  float first = 0, scale = 1;
};

RigTrack part_of(const RigTrack& track, const AxisPart& part, std::vector<std::vector<float>>& data) {
  RigTrack result = track;
  std::vector<float> positions(track.positions.begin(), track.positions.end()), values(track.values.begin(), track.values.end());
  for (float& position : positions) position = part.scale * (position - part.first);
  if (track.interpolation == Interpolation::kCubicSpline) {  // in-tangent, value, out-tangent: slopes over positions
    const size_t width = values.size() / positions.size() / 3;
    for (size_t i = 0; i < values.size(); ++i)
      if (i / width % 3 != 1) values[i] /= part.scale;
  }
  data.push_back(std::move(positions));
  result.positions = data.back();
  data.push_back(std::move(values));
  result.values = data.back();
  return result;
}

}  // namespace

Scene middle_run(const Scene& scene, int samples) {
  check_rigid(scene);
  const Position middle = middle_position(scene);
  const GridIndex sample = scene.space().nearest_sample(middle);
  const AxisMask camera = only_camera_axes(scene);
  Scene run = scene;
  std::vector<AxisPart> parts;
  bool kept = false;
  for (size_t a = 0; a < scene.axes.size(); ++a) {
    AxisShape& shape = run.axes[a].shape;
    const int steps = shape.kind == AxisKind::kPeriodic ? shape.samples : shape.samples - 1,
              count = std::min(samples, shape.samples);
    parts.push_back({middle[a], 1});
    if (!kept && (camera >> a & 1) && moves_between_samples(scene.axes[a]) && count > 1) {
      const auto all = static_cast<float>(steps);
      parts.back() = {static_cast<float>((shape.samples - count) / 2) / all, all / static_cast<float>(count - 1)};
      shape = {AxisKind::kLinear, count};
      kept = true;
    } else {
      shape = {AxisKind::kLinear, 1};
    }
  }
  run.track_data.clear();
  run.track_data.reserve(2 * scene.tracks.size());
  for (RigTrack& track : run.tracks) track = part_of(track, parts[track.axis], run.track_data);
  for (Object& object : run.objects) {
    keep_value(object, sample);
    keep_variant(object, pose_scene(scene, middle).variant);
  }
  for (Light& light : run.lights) keep_value(light, sample);
  return run;
}

}  // namespace vitrine
