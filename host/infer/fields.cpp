// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/fields.h"

#include <algorithm>
#include <map>

namespace vitrine {
namespace {

AxisMask axis_bit(int axis) { return axis >= 0 ? AxisMask{1} << axis : 0; }

AxisMask varying_axes(const ParameterSpace& space) {
  AxisMask mask = 0;
  for (int axis = 0; axis < space.axis_count; ++axis)
    if (space.axes[static_cast<size_t>(axis)].samples > 1) mask |= axis_bit(axis);
  return mask;
}

bool all_unlit(const Scene& scene, const Object& object) {
  const auto unlit = [&](const std::vector<int>& materials) {
    return std::all_of(materials.begin(), materials.end(),
                       [&](int m) { return m >= 0 && scene.materials[static_cast<size_t>(m)].unlit; });
  };
  return !object.geometry.triangle_materials.empty() && unlit(object.geometry.triangle_materials) &&
         std::all_of(object.variant_materials.begin(), object.variant_materials.end(), unlit);
}

}  // namespace

AxisMask only_camera_axes(const Scene& scene) {
  std::vector<bool> carries(scene.nodes.size());  // an object or a light
  const auto mark = [&](int node) {
    for (; node >= 0; node = scene.nodes[static_cast<size_t>(node)].parent) carries[static_cast<size_t>(node)] = true;
  };
  AxisMask others = axis_bit(scene.variant_axis);
  for (const Object& object : scene.objects) {
    if (!object.follows_camera) mark(object.node);
    others |= axis_bit(object.emission_axis);
  }
  for (const Light& light : scene.lights) {
    mark(light.node);
    others |= axis_bit(light.emission_axis);
  }
  for (const RigTrack& track : scene.tracks)
    if (carries[track.node]) others |= AxisMask{1} << track.axis;
  return camera_axes(scene) & ~others;
}

const char* layer_name(Layer layer) { return layer == Layer::kDiffuse ? "diffuse" : "specular"; }

std::vector<BetweenSample> between_samples(const Scene& scene) {
  const ParameterSpace space = scene.space();
  const AxisMask axes = only_camera_axes(scene) & varying_axes(space);
  std::vector<BetweenSample> result;
  for (int64_t sample = 0; sample < space.sample_count(); ++sample) {
    const GridIndex index = space.index_from_flat(sample);
    const Position position = space.position_of(index);
    for (int axis = 0; axis < space.axis_count; ++axis) {
      const auto a = static_cast<size_t>(axis);
      const AxisShape& shape = space.axes[a];
      if (!(axes & axis_bit(axis)) || shape.kind == AxisKind::kDiscrete) continue;
      const bool is_last = index[a] == shape.samples - 1, wraps = shape.kind == AxisKind::kPeriodic;
      if (is_last && !wraps) continue;
      GridIndex next = index;
      next[a] = is_last ? 0 : index[a] + 1;
      BetweenSample between{axis, position, {sample, space.flat_from_index(next)}};
      between.position[a] += 0.5f / static_cast<float>(wraps ? shape.samples : shape.samples - 1);
      result.push_back(between);
    }
  }
  return result;
}

StateTable make_states(const ParameterSpace& space, AxisMask geometry_axes) {
  StateTable table;
  std::map<int64_t, int> numbers;
  for (int64_t sample = 0; sample < space.sample_count(); ++sample) {
    const auto [at, is_new] = numbers.emplace(field_sample_of(space, geometry_axes, sample), static_cast<int>(numbers.size()));
    if (is_new) table.samples_of_state.emplace_back();
    table.state_of_sample.push_back(at->second);
    table.samples_of_state[static_cast<size_t>(at->second)].push_back(sample);
  }
  table.grid_states = static_cast<int>(numbers.size());
  return table;
}

AxisMask field_axes(const Scene& scene, const Object& object, Layer layer) {
  const AxisMask varying = varying_axes(scene.space());
  if (layer == Layer::kSpecular) return varying;
  if (object.follows_camera || all_unlit(scene, object)) {
    const AxisMask own = (object.variant_materials.empty() ? 0 : axis_bit(scene.variant_axis)) | axis_bit(object.emission_axis);
    return own & varying;
  }
  return varying & ~only_camera_axes(scene);
}

int64_t field_sample_of(const ParameterSpace& space, AxisMask axes, int64_t grid_sample) {
  GridIndex index = space.index_from_flat(grid_sample);
  for (int axis = 0; axis < space.axis_count; ++axis)
    if (!(axes & axis_bit(axis))) index[static_cast<size_t>(axis)] = 0;
  return space.restricted(axes).flat_from_index(index);
}

FieldShape blocks_of(const Field& field) {
  FieldShape shape;
  shape.space = field.space;
  shape.block_size = field.block_size;
  shape.stagger = field.stagger;
  shape.pyramid.cell[0] = field.block_size;
  return shape;
}

uint16_t map_number(const Field& field, int64_t flat) {
  if (field.block_maps.empty()) return 0;
  return field.block_maps[static_cast<size_t>(blocks_of(field).block_of(field.space.index_from_flat(flat)))];
}

const TextureMap& map_of(const Field& field, int64_t flat) { return field.maps[map_number(field, flat)]; }

std::vector<int64_t> shown_at(const StateTable& states, const Field& field, int64_t sample) {
  if (sample < states.grid_samples()) return {sample};
  const BetweenSample& between = states.between[static_cast<size_t>(sample - states.grid_samples())];
  if (!(field.axes & axis_bit(between.axis))) return {};
  return {between.beside.begin(), between.beside.end()};
}

std::vector<SolveGroup> make_groups(const ParameterSpace& space, const Field& field, int number, const StateTable& states,
                                    size_t max_textures) {
  std::map<int64_t, std::map<int, std::vector<int64_t>>> seen;  // texture -> state -> samples
  for (size_t sample = 0; sample < states.state_of_sample.size(); ++sample)
    for (const int64_t shown : shown_at(states, field, static_cast<int64_t>(sample)))
      seen[field_sample_of(space, field.axes, shown)][states.state_of_sample[sample]].push_back(static_cast<int64_t>(sample));
  std::map<std::pair<uint16_t, std::vector<int>>, std::vector<int64_t>> alike;  // by map and states
  for (const auto& [texture, uses] : seen) {
    std::vector<int> key;
    for (const auto& use : uses) key.push_back(use.first);
    alike[{map_number(field, texture), key}].push_back(texture);
  }
  std::vector<SolveGroup> groups;
  for (const auto& [key, textures] : alike)
    for (size_t begin = 0; begin < textures.size(); begin += max_textures) {
      SolveGroup group{number,
                       key.first,
                       {textures.begin() + static_cast<ptrdiff_t>(begin),
                        textures.begin() + static_cast<ptrdiff_t>(std::min(textures.size(), begin + max_textures))},
                       {}};
      for (size_t s = 0; s < key.second.size(); ++s) {
        const int state = key.second[s];
        SolveGroup::Use use{state, {}};
        for (const int64_t texture : group.textures) use.samples.push_back(seen[texture][state]);
        group.uses.push_back(std::move(use));
      }
      groups.push_back(std::move(group));
    }
  return groups;
}

}  // namespace vitrine
