// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Fresnel reflectances: Schlick's approximation as glTF 2.0 appendix B uses it, and the exact one for dielectrics that transmit.
#pragma once

#include "host/trace/vector_math.h"

namespace vitrine::trace {

inline float schlick_weight(float cosine) {
  const float m = std::clamp(1 - cosine, 0.0f, 1.0f);
  return sqr(m * m) * m;
}

// Unpolarized reflectance; `cosine` >= 0 on the incident side, `eta` = index of the far side / index of this side.
inline float fresnel_dielectric(float cosine, float eta) {
  const float c = std::clamp(cosine, 0.0f, 1.0f);
  const float sin2_t = (1 - c * c) / (eta * eta);
  if (sin2_t >= 1) return 1;
  const float cos_t = std::sqrt(1 - sin2_t);
  const float parallel = (eta * c - cos_t) / (eta * c + cos_t);
  const float perpendicular = (c - eta * cos_t) / (c + eta * cos_t);
  return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

// Unpolarized, at normal incidence.
inline float normal_reflectance(float ior) { return sqr((ior - 1) / (ior + 1)); }

// What glass reflects of light from outside by KHR_materials_specular: `specular` scales all of it, `color` what is reflected at
// normal incidence (f0) and not what comes to that towards grazing angles. `fresnel` is the reflectance without either. Of
// indices above 3.7 it falls below f0 on the way, which is kept, so that a factor and a colour of 1 change nothing.
inline glm::vec3 glass_reflectance(float fresnel, float f0, float specular, const glm::vec3& color) {
  const float edge = std::min((fresnel - f0) / (1 - f0), 1.0f);
  const glm::vec3 tinted = glm::min(f0 * color, glm::vec3(1));
  return specular * glm::max(tinted + edge * (1.0f - tinted), glm::vec3(0));
}

// The refraction of w (pointing away from the surface, w . n > 0) about n, or false at total internal reflection.
inline bool refract(const glm::vec3& w, const glm::vec3& n, float eta, glm::vec3& refracted) {
  const float cos_i = glm::dot(w, n);
  const float cos2_t = 1 - (1 - cos_i * cos_i) / (eta * eta);
  if (cos2_t <= 0) return false;
  refracted = -w / eta + (cos_i / eta - std::sqrt(cos2_t)) * n;
  return true;
}

}  // namespace vitrine::trace
