// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/albedo.h"

#include "host/trace/fresnel.h"

namespace vitrine::trace {

namespace {

constexpr int kStrata = 24;  // per dimension, midpoint rule over the square that visible normals are drawn from

// Mean over visible normals of `weight(wo, h, ggx)`.
template <typename Weight>
float integrate(float cosine, float roughness, Weight weight) {
  const Ggx ggx{std::max(sqr(roughness), kDeltaAlpha)};
  const glm::vec3 wo(safe_sqrt(1 - cosine * cosine), 0, cosine);
  double sum = 0;
  for (int i = 0; i < kStrata; ++i) {
    for (int j = 0; j < kStrata; ++j) {
      const glm::vec2 u((i + 0.5f) / kStrata, (j + 0.5f) / kStrata);
      sum += weight(wo, ggx.sample_visible(wo, u), ggx);
    }
  }
  return static_cast<float>(sum / (kStrata * kStrata));
}

template <typename Weight>
AlbedoTable tabulate(Weight weight) {
  AlbedoTable table;
  for (int j = 0; j < AlbedoTable::kSize; ++j) {
    for (int i = 0; i < AlbedoTable::kSize; ++i) {
      table.at(i, j) = integrate(AlbedoTable::cosine_of(i), AlbedoTable::roughness_of(j), weight);
    }
  }
  return table;
}

// G2 / G1: what remains of a ray that leaves along wi.
float escape(const Ggx& ggx, const glm::vec3& wo, const glm::vec3& wi) {
  return (1 + ggx.lambda(wo)) / (1 + ggx.lambda(wo) + ggx.lambda(wi));
}

float white_weight(const glm::vec3& wo, const glm::vec3& h, const Ggx& ggx) {
  const glm::vec3 wi = 2 * glm::dot(wo, h) * h - wo;
  return wi.z > 0 ? escape(ggx, wo, wi) : 0;
}

float edge_weight(const glm::vec3& wo, const glm::vec3& h, const Ggx& ggx) {
  return white_weight(wo, h, ggx) * schlick_weight(glm::dot(wo, h));
}

float glass_weight(const glm::vec3& wo, const glm::vec3& h, const Ggx& ggx, float eta) {
  const float reflected = fresnel_dielectric(glm::dot(wo, h), eta);
  float sum = reflected * white_weight(wo, h, ggx);
  glm::vec3 wi;
  if (reflected < 1 && refract(wo, h, eta, wi) && wi.z < 0) sum += (1 - reflected) * escape(ggx, wo, wi);
  return sum;
}

// One lookup of both would save little: tables stay in the first-level cache.
const AlbedoTable& white_table() {
  static const AlbedoTable table = tabulate(white_weight);
  return table;
}

std::array<float, AlbedoTable::kSize> tabulate_means() {
  constexpr int kSteps = 256;
  std::array<float, AlbedoTable::kSize> means{};
  for (int j = 0; j < AlbedoTable::kSize; ++j) {
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      const float cosine = (static_cast<float>(i) + 0.5f) / kSteps;
      sum += 2 * cosine * white_table().lookup(cosine, AlbedoTable::roughness_of(j));
    }
    means[static_cast<size_t>(j)] = static_cast<float>(sum / kSteps);
  }
  return means;
}

}  // namespace

ReflectionAlbedo reflection_albedo(float cosine, float alpha) {
  if (alpha < kDeltaAlpha) return {1, schlick_weight(cosine)};
  static const AlbedoTable edge = tabulate(edge_weight);
  const float roughness = std::sqrt(alpha);
  return {white_table().lookup(cosine, roughness), edge.lookup(cosine, roughness)};
}

float mean_white_albedo(float alpha) {
  static const auto means = tabulate_means();
  const float y = std::sqrt(std::clamp(alpha, 0.0f, 1.0f)) * (AlbedoTable::kSize - 1);
  const auto j = std::min(static_cast<size_t>(y), static_cast<size_t>(AlbedoTable::kSize - 2));
  return means[j] + (y - static_cast<float>(j)) * (means[j + 1] - means[j]);
}

glm::vec3 multiple_scattering(const glm::vec3& f0, const glm::vec3& f90, float mean_white) {
  const glm::vec3 fresnel = f0 + (f90 - f0) * (1.0f / 21.0f);  // cosine-weighted mean of Schlick's
  return fresnel * fresnel * mean_white / (1.0f - fresnel * (1 - mean_white));
}

GlassAlbedo::GlassAlbedo(float ior)
    : entering(tabulate([ior](const auto& wo, const auto& h, const Ggx& g) { return glass_weight(wo, h, g, ior); })),
      leaving(tabulate([ior](const auto& wo, const auto& h, const Ggx& g) { return glass_weight(wo, h, g, 1 / ior); })) {}

}  // namespace vitrine::trace
