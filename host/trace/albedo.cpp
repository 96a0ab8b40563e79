// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/albedo.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <glm/gtc/constants.hpp>
#include <vector>

#include "host/trace/fresnel.h"

namespace vitrine::trace {
namespace {

constexpr int kPoints = 1024;  // of the square that visible normals are drawn from
constexpr int kMeanSteps = 512;  // of means over the hemisphere

// Where visible normals are drawn from: the R2 sequence of Roberts 2018, its first number as a point of the unit circle. Edges
// where lobes meet the horizon cross the square, and a sequence meets them more evenly than a grid.
struct Point {
  glm::vec2 azimuth;
  float u;
};
std::vector<Point> make_points() {
  std::vector<Point> points;
  for (int i = 0; i < kPoints; ++i) {
    const double phi = 2 * glm::pi<double>() * std::fmod((i + 0.5) * 0.7548776662466927, 1.0);
    points.push_back({glm::vec2(std::cos(phi), std::sin(phi)), static_cast<float>(std::fmod((i + 0.5) * 0.5698402909980532, 1.0))});
  }
  return points;
}

// The mean over visible normals of `weight(wo, h, ggx)`.
template <typename Value, typename Weight>
Value integrate(float cosine, float roughness, const std::vector<Point>& points, const Weight& weight) {
  const Ggx ggx{std::max(sqr(roughness), kDeltaAlpha)};
  const glm::vec3 wo(safe_sqrt(1 - cosine * cosine), 0, cosine);
  Value sum{};
  for (const Point& p : points) sum = sum + weight(wo, ggx.visible_normal(wo, p.azimuth, p.u), ggx);
  return 1.0f / kPoints * sum;
}

template <typename Value, typename Weight>
AlbedoTable<Value> tabulate(const Weight& weight) {
  using Table = AlbedoTable<Value>;
  Table table;
  const std::vector<Point> points = make_points();
  const auto fill_row = [&](int j) {
    for (int i = 0; i < Table::kColumns; ++i) {
      table.at(i, j) = integrate<Value>(Table::cosine_of(i), Table::roughness_of(j), points, weight);
    }
  };
  // Isolated: while it waits, this thread must not take up a task that would ask for this very table.
  tbb::this_task_arena::isolate([&] { tbb::parallel_for(0, Table::kRows, fill_row); });
  return table;
}

// Per row, the mean over the hemisphere weighted by the cosine, of what lookup() gives: then sums over directions agree.
template <typename Value>
std::array<Value, AlbedoTable<Value>::kRows> means_of(const AlbedoTable<Value>& table) {
  std::array<Value, AlbedoTable<Value>::kRows> means{};
  for (int j = 0; j < AlbedoTable<Value>::kRows; ++j) {
    Value sum{};
    for (int i = 0; i < kMeanSteps; ++i) {
      const float cosine = (static_cast<float>(i) + 0.5f) / kMeanSteps;
      sum = sum + 2 * cosine / kMeanSteps * table.lookup(cosine, AlbedoTable<Value>::roughness_of(j));
    }
    means[static_cast<size_t>(j)] = sum;
  }
  return means;
}

template <typename Value, size_t kRows>
Value interpolate(const std::array<Value, kRows>& rows, float roughness) {
  const float y = std::clamp(roughness, 0.0f, 1.0f) * (kRows - 1);
  const auto j = std::min(static_cast<size_t>(y), kRows - 2);
  const float t = y - static_cast<float>(j);
  return (1 - t) * rows[j] + t * rows[j + 1];
}

// G2 / G1: what remains of a ray that leaves along wi.
float escape(const Ggx& ggx, const glm::vec3& wo, const glm::vec3& wi) {
  return (1 + ggx.lambda(wo)) / (1 + ggx.lambda(wo) + ggx.lambda(wi));
}

float white_weight(const glm::vec3& wo, const glm::vec3& h, const Ggx& ggx) {
  const glm::vec3 wi = 2 * glm::dot(wo, h) * h - wo;
  return wi.z > 0 ? escape(ggx, wo, wi) : 0;
}

ReflectionAlbedo reflection_weight(const glm::vec3& wo, const glm::vec3& h, const Ggx& ggx) {
  const float white = white_weight(wo, h, ggx);
  return {white, white * schlick_weight(glm::dot(wo, h))};
}

float glass_weight(const glm::vec3& wo, const glm::vec3& h, const Ggx& ggx, float eta) {
  const float reflected = fresnel_dielectric(glm::dot(wo, h), eta);
  float sum = reflected * white_weight(wo, h, ggx);
  glm::vec3 wi;
  if (reflected < 1 && refract(wo, h, eta, wi) && wi.z < 0) sum += (1 - reflected) * escape(ggx, wo, wi);
  return sum;
}

struct ReflectionTables {
  AlbedoTable<ReflectionAlbedo> albedo = tabulate<ReflectionAlbedo>(reflection_weight);
  std::array<ReflectionAlbedo, AlbedoTable<ReflectionAlbedo>::kRows> means = means_of(albedo);
};
const ReflectionTables& reflection_tables() {
  static const ReflectionTables tables;
  return tables;
}

}  // namespace

ReflectionAlbedo reflection_albedo(float cosine, float roughness) {
  if (sqr(roughness) < kDeltaAlpha) return {1, schlick_weight(cosine)};
  return reflection_tables().albedo.lookup(cosine, roughness);
}

ReflectionAlbedo mean_reflection_albedo(float roughness) {
  if (sqr(roughness) < kDeltaAlpha) return {1, 1.0f / 21.0f};  // the integral of 2 c (1 - c)^5
  return interpolate(reflection_tables().means, roughness);
}

glm::vec3 multiple_scattering(const glm::vec3& f0, const glm::vec3& f90, float mean_white) {
  const glm::vec3 fresnel = f0 + (f90 - f0) * (1.0f / 21.0f);  // cosine-weighted mean of Schlick's
  return fresnel * fresnel * mean_white / (1.0f - fresnel * (1 - mean_white));
}

GlassAlbedo::GlassAlbedo(float ior) {
  for (const bool inside : {false, true}) {
    const float eta = inside ? 1 / ior : ior;
    sides_[inside] = tabulate<float>([eta](const auto& wo, const auto& h, const Ggx& g) { return glass_weight(wo, h, g, eta); });
    missing_[inside] = means_of(sides_[inside]);
    for (float& mean : missing_[inside]) mean = std::max(1 - mean, 1e-6f);
  }
  for (int i = 0; i < kMeanSteps; ++i) {
    const float cosine = (static_cast<float>(i) + 0.5f) / kMeanSteps;
    transmittance_[0] += 2 * cosine / kMeanSteps * (1 - fresnel_dielectric(cosine, ior));
  }
  transmittance_[1] = transmittance_[0] / sqr(ior);
}

float GlassAlbedo::mean_missing(float roughness, bool inside) const { return interpolate(missing_[inside], roughness); }

float GlassAlbedo::crossing(float roughness, bool inside) const {
  const float here = mean_missing(roughness, inside), there = mean_missing(roughness, !inside);
  // transmittance * index^2 is the same from both sides, so any common factor keeps the tie; this one keeps shares below one.
  return transmittance_[inside] * there / std::max(here, there);
}

}  // namespace vitrine::trace
