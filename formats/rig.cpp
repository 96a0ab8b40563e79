// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/rig.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/vec4.hpp>

namespace vitrine {
namespace {

// Between passes each node's TRS is kept in its own output matrix, so that nothing needs to be allocated: column 0 is the
// translation, column 1 the rotation (x, y, z, w), column 2 the scale.
constexpr int kColumnOfPath[] = {0, 1, 2};

glm::vec4 normalized_rotation(const glm::vec4& q) {
  const float length = std::sqrt(glm::dot(q, q));
  return length > 0 ? q / length : glm::vec4(0, 0, 0, 1);
}

glm::vec4 read_value(const RigTrack& track, size_t index) {
  if (track.path == TrackPath::kRotation) {
    const float* v = track.values.data() + 4 * index;
    return {v[0], v[1], v[2], v[3]};
  }
  const float* v = track.values.data() + 3 * index;
  return {v[0], v[1], v[2], 0};
}

// glTF 2.0, appendix C.4: along the shorter arc; near-equal rotations are mixed linearly.
glm::vec4 slerp(const glm::vec4& from, const glm::vec4& to, float t) {
  const float d = glm::dot(from, to), sign = d < 0 ? -1.0f : 1.0f, cosine = std::min(std::fabs(d), 1.0f);
  if (cosine > 0.99999f) return normalized_rotation(from * (1 - t) + to * (sign * t));
  const float angle = std::acos(cosine), scale = 1 / std::sin(angle);
  return from * (std::sin((1 - t) * angle) * scale) + to * (sign * std::sin(t * angle) * scale);
}

glm::vec4 mix(const RigTrack& track, const glm::vec4& from, const glm::vec4& to, float t) {
  if (track.path != TrackPath::kRotation) return from + (to - from) * t;
  return slerp(normalized_rotation(from), normalized_rotation(to), t);
}

// glTF 2.0, appendix C.5. A key holds in-tangent, value, out-tangent; `width` is the distance between the two keys.
glm::vec4 cubic(const RigTrack& track, size_t key, float t, float width) {
  const glm::vec4 v0 = read_value(track, 3 * key + 1), out = read_value(track, 3 * key + 2);
  const glm::vec4 in = read_value(track, 3 * key + 3), v1 = read_value(track, 3 * key + 4);
  const float t2 = t * t, t3 = t2 * t;
  return v0 * (2 * t3 - 3 * t2 + 1) + out * (width * (t3 - 2 * t2 + t)) + v1 * (3 * t2 - 2 * t3) + in * (width * (t3 - t2));
}

}  // namespace

glm::vec4 sample_track(const RigTrack& track, float position) {
  const bool spline = track.interpolation == Interpolation::kCubicSpline;
  const auto value_of_key = [&](size_t key) { return read_value(track, spline ? 3 * key + 1 : key); };
  const auto after = std::upper_bound(track.positions.begin(), track.positions.end(), position);
  if (after == track.positions.begin()) return value_of_key(0);
  const size_t key = static_cast<size_t>(after - track.positions.begin()) - 1;
  if (after == track.positions.end() || track.interpolation == Interpolation::kStep) return value_of_key(key);
  const float width = *after - track.positions[key], t = (position - track.positions[key]) / width;
  return spline ? cubic(track, key, t, width) : mix(track, value_of_key(key), value_of_key(key + 1), t);
}

namespace {

// T * R * S, with the rotation made unit first.
glm::mat4 matrix_from_packed(const glm::mat4& packed) {
  const glm::vec4 r = normalized_rotation(packed[1]);
  glm::mat4 matrix = glm::mat4_cast(glm::quat(r.w, r.x, r.y, r.z));
  for (int column = 0; column < 3; ++column) matrix[column] *= packed[2][column];
  matrix[3] = glm::vec4(glm::vec3(packed[0]), 1);
  return matrix;
}

float clamp_position(float p) { return p >= 0 ? std::min(p, 1.0f) : 0.0f; }  // NaN becomes 0

}  // namespace

void evaluate_rig(const Rig& rig, const Position& position, std::span<glm::mat4> world_from_node) {
  for (size_t n = 0; n < rig.nodes.size(); ++n) {
    const RigNode& node = rig.nodes[n];
    const glm::vec4 rotation(node.rotation.x, node.rotation.y, node.rotation.z, node.rotation.w);
    world_from_node[n] = glm::mat4(glm::vec4(node.translation, 0), rotation, glm::vec4(node.scale, 0), glm::vec4(0));
  }
  for (const RigTrack& track : rig.tracks)
    world_from_node[track.node][kColumnOfPath[static_cast<int>(track.path)]] =
        sample_track(track, clamp_position(position[track.axis]));
  for (size_t n = 0; n < rig.nodes.size(); ++n) {
    const glm::mat4 parent_from_node = matrix_from_packed(world_from_node[n]) * rig.nodes[n].matrix;
    const int32_t parent = rig.nodes[n].parent;
    world_from_node[n] = parent < 0 ? parent_from_node : world_from_node[static_cast<size_t>(parent)] * parent_from_node;
  }
}

glm::mat4 clip_from_camera(const Camera& camera, float aspect) {
  if (camera.perspective) return glm::perspectiveRH_NO(camera.yfov, aspect, camera.near_distance, camera.far_distance);
  const float ymag = camera.ymag, xmag = ymag * aspect;
  return glm::orthoRH_NO(-xmag, xmag, -ymag, ymag, camera.near_distance, camera.far_distance);
}

}  // namespace vitrine
