// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The isotropic GGX microfacet distribution (Walter et al. 2007) with height-correlated Smith shadowing (Heitz 2014) and
// sampling of visible normals by spherical caps (Dupuy & Benyoub 2023). Local space, +Z is the surface normal.
#pragma once

#include "host/trace/vector_math.h"

namespace vitrine::trace {

// Below this alpha a lobe counts as a delta: its width is less than a pixel's at any resolution that is played.
inline constexpr float kDeltaAlpha = 1e-3f;

struct Ggx {
  float alpha;

  float density(const glm::vec3& h) const {
    const float a2 = alpha * alpha;
    const float t = (h.x * h.x + h.y * h.y) / a2 + h.z * h.z;
    return kInvPi / (a2 * t * t);
  }
  float lambda(const glm::vec3& w) const {
    const float tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
    return 0.5f * (std::sqrt(1 + alpha * alpha * tan2) - 1);
  }
  float masking(const glm::vec3& w) const { return 1 / (1 + lambda(w)); }
  float masking_shadowing(const glm::vec3& wo, const glm::vec3& wi) const { return 1 / (1 + lambda(wo) + lambda(wi)); }
  // Density of visible normals seen from wo, wo.z > 0.
  float visible_density(const glm::vec3& wo, const glm::vec3& h) const {
    return masking(wo) * std::max(glm::dot(wo, h), 0.0f) * density(h) / wo.z;
  }
  glm::vec3 sample_visible(const glm::vec3& wo, const glm::vec2& u) const {
    const float phi = 2 * kPi * u.x;
    return visible_normal(wo, {std::cos(phi), std::sin(phi)}, u.y);
  }
  // The same for a point of the unit circle and a number in [0, 1).
  glm::vec3 visible_normal(const glm::vec3& wo, const glm::vec2& azimuth, float u) const {
    const glm::vec3 stretched = glm::normalize(glm::vec3(alpha * wo.x, alpha * wo.y, wo.z));
    const float z = (1 - u) * (1 + stretched.z) - stretched.z;
    const float r = safe_sqrt(1 - z * z);
    const glm::vec3 h = glm::vec3(r * azimuth.x, r * azimuth.y, z) + stretched;
    return glm::normalize(glm::vec3(alpha * h.x, alpha * h.y, std::max(h.z, 1e-7f)));
  }
};

}  // namespace vitrine::trace
