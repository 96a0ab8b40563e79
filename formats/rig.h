// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The rig: the nodes that carry camera, objects and lights, and the tracks by which axes move them. Host and target
// evaluate it with this one function, so what is traced and inverted is what will be drawn.
#pragma once

#include <cstdint>
#include <span>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "formats/parameter_space.h"

namespace vitrine {

struct RigNode {
  int32_t parent = -1;  // an earlier node, or -1: nodes are stored parents first
  glm::vec3 translation{0};
  glm::quat rotation{1, 0, 0, 0};  // w, x, y, z; unit
  glm::vec3 scale{1};
  // A glTF node given by a matrix: multiplied after the TRS above (which is then the identity and not animated).
  glm::mat4 matrix{1};
};

enum class TrackPath : uint8_t { kTranslation, kRotation, kScale };
enum class Interpolation : uint8_t { kStep, kLinear, kCubicSpline };  // glTF 2.0, appendix C

// Replaces one of a node's T, R, S by a value that depends on one axis.
struct RigTrack {
  uint32_t node = 0;
  uint32_t axis = 0;
  TrackPath path = TrackPath::kTranslation;
  Interpolation interpolation = Interpolation::kLinear;
  std::span<const float> positions;  // key positions along the axis in [0, 1], strictly ascending, at least one
  // Per key 3 floats (T, S) or 4 (R: x, y, z, w as glTF stores it); three times that for kCubicSpline (in-tangent, value,
  // out-tangent; tangents already scaled to positions, not seconds).
  std::span<const float> values;
};

// The value at a position along its axis, held before the first key and after the last: x, y, z and for rotations w.
glm::vec4 sample_track(const RigTrack& track, float position);

struct Rig {
  std::span<const RigNode> nodes;
  std::span<const RigTrack> tracks;
};

// world_from_node for every node at `position`; `world_from_node.size()` must be rig.nodes.size(). Allocates nothing.
void evaluate_rig(const Rig& rig, const Position& position, std::span<glm::mat4> world_from_node);

struct Camera {
  int32_t node = 0;              // looks along its -Z, +Y up (glTF)
  bool perspective = true;
  float yfov = 0.7f;             // radians, perspective only
  float ymag = 1.0f;             // half height in metres, orthographic only
  float near_distance = 0.01f;   // metres
  float far_distance = 100.0f;
};

// GL clip space (z in [-1, 1]). `aspect` is width / height.
glm::mat4 clip_from_camera(const Camera& camera, float aspect);

}  // namespace vitrine
