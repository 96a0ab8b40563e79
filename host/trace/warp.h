// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Maps of the unit square to the domains that paths sample (Shirley & Chiu 1997 for the disk).
#pragma once

#include "host/trace/vector_math.h"

namespace vitrine::trace {

// The angle about the nearest axis is at most a quarter of pi, where Taylor's polynomials are exact to a float's last bits:
// faster than a library's sine, and the same with every library.
inline glm::vec2 concentric_disk(const glm::vec2& u) {
  const float a = 2 * u.x - 1, b = 2 * u.y - 1;
  const bool wide = std::fabs(a) > std::fabs(b);
  const float r = wide ? a : b, other = wide ? b : a;
  const float phi = r == 0 ? 0 : (kPi / 4) * (other / r), p = phi * phi;
  const float cosine = 1 + p * (-1.0f / 2 + p * (1.0f / 24 + p * (-1.0f / 720 + p * (1.0f / 40320))));
  const float sine = phi * (1 + p * (-1.0f / 6 + p * (1.0f / 120 + p * (-1.0f / 5040 + p * (1.0f / 362880)))));
  return {r * (wide ? cosine : sine), r * (wide ? sine : cosine)};
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
