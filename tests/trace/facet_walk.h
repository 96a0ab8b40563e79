// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Light that walks from facet to facet of a GGX surface until it leaves: Heitz, Hanika, d'Eon & Dachsbacher, "Multiple-scattering
// microfacet BSDFs with the Smith model" (2016), with heights of facets distributed evenly in [-1, 1]. Slow and exact: what
// host/trace/bsdf.h approximates by a nearly diffuse lobe, and what independent renderers do. Local space, +Z is the normal.
#pragma once

#include <cmath>
#include <limits>
#include <random>

#include "host/trace/fresnel.h"
#include "host/trace/ggx.h"

namespace vitrine::test {

class FacetWalk {
 public:
  // `eta`: index of the far side / of this side; 0: facets are perfect mirrors.
  FacetWalk(float alpha, float eta) : ggx_{alpha}, eta_(eta) {}

  // The direction in which light seen from `wo` (wo.z > 0) came: no weight is left to give. z < 0: from the far side.
  glm::vec3 sample(const glm::vec3& wo, std::mt19937& random) const {
    constexpr int kMaxFacets = 1000;
    glm::vec3 w = -wo;
    float height = 1;
    bool here = true;
    for (int i = 0; i < kMaxFacets; ++i) {
      // The far side is the same surface turned over.
      height = here ? next_facet(w, height, uniform(random)) : -next_facet(-w, -height, uniform(random));
      if (std::isinf(height)) return w;
      w = leave_facet(-w, here, random);
    }
    return w;
  }

 private:
  static float uniform(std::mt19937& random) { return static_cast<float>(random() >> 8) * 0x1p-24f; }
  static float share_below(float height) { return std::clamp(0.5f * (height + 1), 0.0f, 1.0f); }

  // Heitz's Lambda for directions of both signs.
  float lambda(const glm::vec3& w) const {
    const float a = w.z / (ggx_.alpha * std::sqrt(std::max(1 - w.z * w.z, 1e-12f)));
    return 0.5f * (-1 + std::copysign(std::sqrt(1 + 1 / (a * a)), a));
  }
  // Where a ray at `height` going along `w` meets a facet, or infinity. Supplemental material of the paper, eq. 36.
  float next_facet(const glm::vec3& w, float height, float u) const {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    if (w.z > 0.9999f) return kInfinity;
    if (w.z < -0.9999f) return 2 * u * share_below(height) - 1;
    if (std::fabs(w.z) < 1e-4f) return height;
    const float escape = w.z > 0 ? std::pow(share_below(height), lambda(w)) : 0;
    if (u > 1 - escape) return kInfinity;
    return 2 * std::min(share_below(height) / std::pow(1 - u, 1 / lambda(w)), 1.0f) - 1;
  }
  // From a facet that is met seen from `w`; `here` is the side that `w` is on and becomes that of the result.
  glm::vec3 leave_facet(const glm::vec3& w, bool& here, std::mt19937& random) const {
    const float side = here ? 1.0f : -1.0f;
    const glm::vec2 u(uniform(random), uniform(random));
    const glm::vec3 facet = side * ggx_.sample_visible(side * w, u);
    const glm::vec3 mirrored = 2 * glm::dot(w, facet) * facet - w;
    if (eta_ == 0) return mirrored;
    const float eta = here ? eta_ : 1 / eta_;
    glm::vec3 refracted;
    if (uniform(random) < trace::fresnel_dielectric(glm::dot(w, facet), eta) || !trace::refract(w, facet, eta, refracted))
      return mirrored;
    here = !here;
    return glm::normalize(refracted);
  }

  trace::Ggx ggx_;
  float eta_;
};

}  // namespace vitrine::test
