// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/frozen_scene.h"

#include <algorithm>
#include <array>

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

// Consecutive samples of an axis.
struct AxisPart {
  int first = 0, count = 1;
};
using GridPart = std::array<AxisPart, kMaxAxes>;

template <typename Value>
std::vector<Value> kept(const std::vector<Value>& values, const AxisPart& part) {
  return {values.begin() + part.first, values.begin() + part.first + part.count};
}

// Keeps of what is switched by axes the values at a part of the grid.
void keep_values(Scene& scene, const GridPart& parts) {
  const auto keep = [&](auto& emitter) {
    if (emitter.emission_axis >= 0)
      emitter.emission_of_value = kept(emitter.emission_of_value, parts[static_cast<size_t>(emitter.emission_axis)]);
  };
  for (Light& light : scene.lights) keep(light);
  for (Object& object : scene.objects) {
    keep(object);
    if (scene.variant_axis >= 0 && !object.variant_materials.empty())
      object.variant_materials = kept(object.variant_materials, parts[static_cast<size_t>(scene.variant_axis)]);
  }
}

}  // namespace

Position middle_position(const Scene& scene) {
  const ParameterSpace space = scene.space();
  GridIndex index{};
  for (size_t a = 0; a < scene.axes.size(); ++a) index[a] = (scene.axes[a].shape.samples - 1) / 2;
  return space.position_of(index);
}

int64_t middle_sample(const Scene& scene) {
  const ParameterSpace space = scene.space();
  return space.flat_from_index(space.nearest_sample(middle_position(scene)));
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
  GridPart parts{};
  for (size_t a = 0; a < scene.axes.size(); ++a) parts[a].first = sample[a];
  keep_values(frozen, parts);
  for (Axis& axis : frozen.axes) axis.shape = {AxisKind::kLinear, 1};
  return frozen;
}

namespace {

// What a track says at the samples of a part of its axis; between them it goes straight.
RigTrack part_of(const RigTrack& track, const Scene& whole, const Scene& part, int first, std::vector<std::vector<float>>& data) {
  const auto axis = static_cast<size_t>(track.axis);
  const int width = track.path == TrackPath::kRotation ? 4 : 3;
  std::vector<float> positions, values;
  for (GridIndex index{}; index[axis] < part.axes[axis].shape.samples; ++index[axis]) {
    GridIndex original{};
    original[axis] = first + index[axis];
    const glm::vec4 value = sample_track(track, whole.space().position_of(original)[axis]);
    positions.push_back(part.space().position_of(index)[axis]);
    for (int i = 0; i < width; ++i) values.push_back(value[i]);
  }
  RigTrack result = track;
  if (track.interpolation == Interpolation::kCubicSpline) result.interpolation = Interpolation::kLinear;
  data.push_back(std::move(positions));
  result.positions = data.back();
  data.push_back(std::move(values));
  result.values = data.back();
  return result;
}

}  // namespace

Scene middle_part(const Scene& scene, std::span<const int> samples) {
  check_rigid(scene);
  Scene part = scene;
  GridPart parts{};
  for (size_t a = 0; a < scene.axes.size(); ++a) {
    AxisShape& shape = part.axes[a].shape;
    const int all = shape.samples, count = std::clamp(samples[a], 1, all);
    parts[a] = {(all - count) / 2, count};
    if (count < all) shape = {shape.kind == AxisKind::kDiscrete ? AxisKind::kDiscrete : AxisKind::kLinear, count};
  }
  part.track_data.clear();
  part.track_data.reserve(2 * scene.tracks.size());
  for (RigTrack& track : part.tracks) track = part_of(track, scene, part, parts[track.axis].first, part.track_data);
  keep_values(part, parts);
  return part;
}

Scene middle_run(const Scene& scene, int samples) {
  const AxisMask camera = only_camera_axes(scene);
  std::array<int, kMaxAxes> counts;
  counts.fill(1);
  for (size_t a = 0; a < scene.axes.size(); ++a)
    if ((camera >> a & 1) && moves_between_samples(scene.axes[a])) {
      counts[a] = samples;
      break;
    }
  return middle_part(scene, counts);
}

}  // namespace vitrine
