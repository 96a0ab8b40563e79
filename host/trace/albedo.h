// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Directional albedos of microfacet lobes, tabulated. They make lobes keep their energy: single-scattering GGX loses light
// between facets, which reflections get back as a second, nearly diffuse lobe (Kulla & Conty, "Revisiting physically based
// shading", 2017) and rough glass as a scale by its albedo (Turquin, "Practical multiple scattering compensation for microfacet
// models", 2019); and the diffuse lobe under a dielectric gets what the dielectric does not reflect.
#pragma once

#include <array>

#include "host/trace/ggx.h"

namespace vitrine::trace {

// A table over (cosine, roughness), roughness = sqrt(alpha); both axes in [0, 1].
class AlbedoTable {
 public:
  static constexpr int kSize = 32;
  float lookup(float cosine, float roughness) const {
    const float x = std::sqrt(std::clamp(cosine, 0.0f, 1.0f)) * (kSize - 1);
    const float y = std::clamp(roughness, 0.0f, 1.0f) * (kSize - 1);
    const int i = std::min(static_cast<int>(x), kSize - 2), j = std::min(static_cast<int>(y), kSize - 2);
    const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
    const float* row = &values_[static_cast<size_t>(j * kSize + i)];
    const float low = row[0] + s * (row[1] - row[0]);
    const float high = row[kSize] + s * (row[kSize + 1] - row[kSize]);
    return low + t * (high - low);
  }
  // Value at a node: cosine of column i, roughness of row j.
  static float cosine_of(int i) { return std::max(sqr(static_cast<float>(i) / (kSize - 1)), 1e-4f); }
  static float roughness_of(int j) { return static_cast<float>(j) / (kSize - 1); }
  float& at(int i, int j) { return values_[static_cast<size_t>(j * kSize + i)]; }

 private:
  std::array<float, kSize * kSize> values_{};
};

// Reflection by single scattering: the albedo for Fresnel 1 is `white`; for Schlick it is f0 * (white - edge) + f90 * edge.
struct ReflectionAlbedo {
  float white, edge;
  glm::vec3 schlick(const glm::vec3& f0, const glm::vec3& f90) const { return f0 * (white - edge) + f90 * edge; }
};
ReflectionAlbedo reflection_albedo(float cosine, float alpha);
// The mean of `white` over the hemisphere, weighted by the cosine.
float mean_white_albedo(float alpha);
// Of the light that single scattering misses, the share that comes out in the end (Kulla & Conty, p. 16), for Schlick's Fresnel.
glm::vec3 multiple_scattering(const glm::vec3& f0, const glm::vec3& f90, float mean_white);

// Share of light that rough glass of one index reflects or transmits by single scattering, from outside and from inside.
struct GlassAlbedo {
  explicit GlassAlbedo(float ior);
  float lookup(float cosine, float alpha, bool inside) const {
    return (inside ? leaving : entering).lookup(cosine, std::sqrt(alpha));
  }
  AlbedoTable entering, leaving;
};

}  // namespace vitrine::trace
