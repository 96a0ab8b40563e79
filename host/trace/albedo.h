// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Directional albedos of microfacet lobes, tabulated. They make lobes keep their energy: what single-scattering GGX loses between
// facets comes back as a second, nearly diffuse lobe (Kulla & Conty, "Revisiting physically based shading", 2017: metals p. 14,
// dielectrics p. 20), and the diffuse lobe under a dielectric gets what the dielectric does not reflect. Roughness is glTF's:
// the square root of alpha.
#pragma once

#include <array>
#include <memory>

#include "host/trace/ggx.h"

namespace vitrine::trace {

// Values over (cosine, roughness), both in [0, 1], bilinear between nodes. Columns are dense at grazing angles, rows at low
// roughness, where albedos bend most.
template <typename Value>
class AlbedoTable {
 public:
  static constexpr int kColumns = 32, kRows = 40;
  Value lookup(float cosine, float roughness) const {
    const float x = std::sqrt(std::clamp(cosine, 0.0f, 1.0f)) * (kColumns - 1);
    const float y = std::clamp(roughness, 0.0f, 1.0f) * (kRows - 1);
    const int i = std::min(static_cast<int>(x), kColumns - 2), j = std::min(static_cast<int>(y), kRows - 2);
    const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
    const Value* row = &values_[static_cast<size_t>(j * kColumns + i)];
    return (1 - t) * ((1 - s) * row[0] + s * row[1]) + t * ((1 - s) * row[kColumns] + s * row[kColumns + 1]);
  }
  // Value at a node: cosine of column i, roughness of row j.
  static float cosine_of(int i) { return std::max(sqr(static_cast<float>(i) / (kColumns - 1)), 1e-4f); }
  static float roughness_of(int j) { return static_cast<float>(j) / (kRows - 1); }
  Value& at(int i, int j) { return values_[static_cast<size_t>(j * kColumns + i)]; }

 private:
  std::array<Value, static_cast<size_t>(kColumns) * kRows> values_{};
};

// Reflection by single scattering: the albedo for Fresnel 1 is `white`; for Schlick it is f0 * (white - edge) + f90 * edge.
struct ReflectionAlbedo {
  float white, edge;
  glm::vec3 schlick(const glm::vec3& f0, const glm::vec3& f90) const { return f0 * (white - edge) + f90 * edge; }
  friend ReflectionAlbedo operator*(float s, const ReflectionAlbedo& a) { return {s * a.white, s * a.edge}; }
  friend ReflectionAlbedo operator+(const ReflectionAlbedo& a, const ReflectionAlbedo& b) {
    return {a.white + b.white, a.edge + b.edge};
  }
};
ReflectionAlbedo reflection_albedo(float cosine, float roughness);
// Its mean over the hemisphere, weighted by the cosine.
ReflectionAlbedo mean_reflection_albedo(float roughness);
// What a coat of glTF (index 1.5) reflects, by its albedo for Fresnel 1.
inline float coat_reflectance(const ReflectionAlbedo& albedo) { return 0.04f * (albedo.white - albedo.edge) + albedo.edge; }
// Of the light that single scattering misses, the share that comes out in the end (Kulla & Conty, p. 16), for Schlick's Fresnel.
glm::vec3 multiple_scattering(const glm::vec3& f0, const glm::vec3& f90, float mean_white);

// Share of light that a rough interface of one index reflects or transmits by single scattering.
class GlassAlbedo {
 public:
  explicit GlassAlbedo(float ior);  // >= 1
  // Met from outside or inside of the solid.
  float lookup(float cosine, float roughness, bool inside) const { return sides_[inside].lookup(cosine, roughness); }
  // What is missing, 1 - lookup(), in the mean over the hemisphere weighted by the cosine.
  float mean_missing(float roughness, bool inside) const;
  // Of the missing light, the share that crosses the interface. Kulla & Conty, p. 20: the shares of the two sides are tied by
  // reciprocity, share * mean_missing * index^2 being the same from both, and to the smooth interface's mean transmittances.
  float crossing(float roughness, bool inside) const;

 private:
  std::array<AlbedoTable<float>, 2> sides_;                                // outside, inside
  std::array<std::array<float, AlbedoTable<float>::kRows>, 2> missing_{};  // means per row
  std::array<float, 2> transmittance_{};                                   // of the smooth interface: 1 - mean Fresnel
};

}  // namespace vitrine::trace
