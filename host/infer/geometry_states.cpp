// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/geometry_states.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <glm/matrix.hpp>
#include <map>
#include <string>

namespace vitrine {
namespace {

std::string bytes_of(const GeometryState& state) {
  std::string bytes(state.clip_from_object.size() * sizeof(glm::mat4), '\0');
  std::memcpy(bytes.data(), state.clip_from_object.data(), bytes.size());
  return bytes;
}

std::array<glm::vec3, 8> box_corners(const DrawnObject& object) {
  glm::vec3 low(1e30f), high(-1e30f);
  for (const MeshVertex& v : object.vertices) {
    low = glm::min(low, glm::vec3(v.x, v.y, v.z));
    high = glm::max(high, glm::vec3(v.x, v.y, v.z));
  }
  std::array<glm::vec3, 8> corners;
  for (size_t i = 0; i < 8; ++i) corners[i] = {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z};
  return corners;
}

// All corners beyond one and the same plane of the clip volume.
bool is_outside(const std::array<glm::vec3, 8>& corners, const glm::mat4& clip_from_object) {
  unsigned beyond_all = 63;
  for (const glm::vec3& corner : corners) {
    const glm::vec4 c = clip_from_object * glm::vec4(corner, 1);
    unsigned beyond = 0;
    for (int d = 0; d < 3; ++d) beyond |= (c[d] < -c.w ? 1u : 0u) << (2 * d) | (c[d] > c.w ? 2u : 0u) << (2 * d);
    beyond_all &= beyond;
  }
  return beyond_all != 0;
}

// Adds states, those that are the same bytes once.
class DistinctStates {
 public:
  explicit DistinctStates(std::vector<GeometryState>& states) : states_(states) {}
  int number_of(GeometryState state) {
    const auto [at, is_new] = numbers_.emplace(bytes_of(state), static_cast<int>(states_.size()));
    if (is_new) states_.push_back(std::move(state));
    return at->second;
  }

 private:
  std::vector<GeometryState>& states_;
  std::map<std::string, int> numbers_;
};

Position on_axes(Position position, AxisMask axes) {
  for (size_t a = 0; a < position.size(); ++a)
    if (!(axes >> a & 1)) position[a] = 0;
  return position;
}

}  // namespace

GeometryState geometry_state_at(const Scene& scene, int64_t grid_sample, std::span<const DrawnObject> objects, float aspect) {
  const ParameterSpace space = scene.space();
  return geometry_state_at(scene, space.position_of(space.index_from_flat(grid_sample)), objects, aspect);
}

GeometryState geometry_state_at(const Scene& scene, const Position& position, std::span<const DrawnObject> objects,
                                float aspect) {
  const Pose pose = pose_scene(scene, position);
  const glm::mat4 clip_from_world = clip_from_camera(scene.camera, aspect) * glm::inverse(pose.world_from_camera);
  GeometryState state;
  for (const DrawnObject& object : objects) {
    const glm::mat4 world = world_from_object(scene, pose, object.object);
    state.clip_from_object.push_back(clip_from_world * world);
    state.mirrored.push_back(glm::determinant(glm::mat3(world)) < 0);
  }
  return state;
}

GeometryStates make_geometry_states(const Scene& scene, AxisMask geometry_axes, std::span<const DrawnObject> objects,
                                    float aspect, std::vector<BetweenSample> between) {
  const StateTable by_axes = make_states(scene.space(), geometry_axes);
  GeometryStates result;
  StateTable& table = result.table;
  DistinctStates of_grid(result.states), of_between(result.states);
  std::vector<int> merged;
  for (const auto& samples : by_axes.samples_of_state)
    merged.push_back(of_grid.number_of(geometry_state_at(scene, samples.front(), objects, aspect)));
  for (const int state : by_axes.state_of_sample) table.state_of_sample.push_back(merged[static_cast<size_t>(state)]);
  table.grid_states = static_cast<int>(result.states.size());

  std::map<Position, int> numbers;
  for (const BetweenSample& sample : between) {
    const auto [at, is_new] = numbers.emplace(on_axes(sample.position, geometry_axes), 0);
    if (is_new) at->second = of_between.number_of(geometry_state_at(scene, sample.position, objects, aspect));
    table.state_of_sample.push_back(at->second);
  }
  table.between = std::move(between);

  table.samples_of_state.resize(result.states.size());
  for (size_t sample = 0; sample < table.state_of_sample.size(); ++sample)
    table.samples_of_state[static_cast<size_t>(table.state_of_sample[sample])].push_back(static_cast<int64_t>(sample));
  return result;
}

bool may_be_seen(const DrawnObject& object, size_t number, std::span<const GeometryState> states) {
  const auto corners = box_corners(object);
  return std::any_of(states.begin(), states.end(),
                     [&](const GeometryState& state) { return !is_outside(corners, state.clip_from_object[number]); });
}

}  // namespace vitrine
