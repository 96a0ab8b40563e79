// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Small vector helpers of the tracer: orthonormal bases, colour measures, safe roots.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace vitrine::trace {

inline constexpr float kPi = 3.14159265358979f;
inline constexpr float kInvPi = 1.0f / kPi;
inline constexpr float kBeforeOne = 0x1.fffffep-1f;  // the greatest float below 1

inline float safe_sqrt(float x) { return std::sqrt(std::max(x, 0.0f)); }
inline float sqr(float x) { return x * x; }
inline float luminance(const glm::vec3& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }
inline float max_component(const glm::vec3& c) { return std::max(c.x, std::max(c.y, c.z)); }
inline bool is_black(const glm::vec3& c) { return c.x == 0 && c.y == 0 && c.z == 0; }

// A right-handed orthonormal basis around a unit normal: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
struct Basis {
  glm::vec3 tangent{1, 0, 0}, bitangent{0, 1, 0}, normal{0, 0, 1};

  Basis() = default;
  explicit Basis(const glm::vec3& n) : normal(n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
  }
  glm::vec3 to_local(const glm::vec3& v) const { return {glm::dot(v, tangent), glm::dot(v, bitangent), glm::dot(v, normal)}; }
  glm::vec3 to_world(const glm::vec3& v) const { return v.x * tangent + v.y * bitangent + v.z * normal; }
};

}  // namespace vitrine::trace
