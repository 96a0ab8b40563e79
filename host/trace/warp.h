// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Maps of the unit square to the domains that paths sample (Shirley & Chiu 1997 for the disk).
#pragma once

#include "host/trace/vector_math.h"

namespace vitrine::trace {

inline glm::vec2 concentric_disk(const glm::vec2& u) {
  const float a = 2 * u.x - 1, b = 2 * u.y - 1;
  if (a == 0 && b == 0) return {0, 0};
  const bool wide = std::fabs(a) > std::fabs(b);
  const float r = wide ? a : b;
  const float phi = wide ? (kPi / 4) * (b / a) : (kPi / 2) - (kPi / 4) * (a / b);
  return {r * std::cos(phi), r * std::sin(phi)};
}

// Density cos(theta) / pi about +Z.
inline glm::vec3 cosine_hemisphere(const glm::vec2& u) {
  const glm::vec2 d = concentric_disk(u);
  return {d.x, d.y, safe_sqrt(1 - d.x * d.x - d.y * d.y)};
}

// Barycentric weights of the second and third corner, uniform by area.
inline glm::vec2 uniform_triangle(const glm::vec2& u) {
  const float s = std::sqrt(u.x);
  return {s * (1 - u.y), s * u.y};
}

}  // namespace vitrine::trace
