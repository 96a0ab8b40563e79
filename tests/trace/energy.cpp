// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The scattering of a single surface: what comes out of it in a white furnace is what went in, and light may run either way.
#include <gtest/gtest.h>

#include <glm/trigonometric.hpp>
#include <random>

#include "host/trace/bsdf.h"

namespace vitrine::trace {
namespace {

constexpr double kEnergyBound = 0.005;  // what may be lost or gained

const glm::vec3 kUp(0, 0, 1);

// As materials make them: shares of a surface that add to one.
SurfaceParameters surface(float roughness, float metal, float glass) {
  SurfaceParameters p;
  p.alpha = roughness * roughness;
  p.metal = metal;
  p.metal_f0 = glm::vec3(1);
  p.glass = (1 - metal) * glass;
  p.dielectric = (1 - metal) * (1 - glass);
  p.diffuse = glm::vec3(p.dielectric);
  p.dielectric_f90 = glm::vec3(1);
  return p;
}
void set_index(SurfaceParameters& p, float ior) {
  p.ior = ior;
  p.dielectric_f0 = glm::vec3(sqr((ior - 1) / (ior + 1)));
}

glm::vec3 direction_at(float degrees, bool below = false) {
  const float a = glm::radians(degrees);
  return {std::sin(a), 0, below ? -std::cos(a) : std::cos(a)};
}

// What an eye sees of the surface inside of radiance 1 (times the squared index in solids, as in every furnace).
double furnace(const SurfaceParameters& p, const glm::vec3& wo, int draws) {
  const Bsdf bsdf(p, wo, kUp, kUp, kUp);
  const float far_index = bsdf.inside() ? 1 / p.ior : p.ior;
  double sum = 0;
  for (int i = 0; i < draws; ++i) {  // the R3 sequence of Roberts 2018
    const double n = i + 0.5;
    const auto u = [&](double step) { return static_cast<float>(std::fmod(n * step, 1.0)); };
    const glm::vec2 point(u(0.8191725134), u(0.6710436067));
    BsdfSample s;
    if (bsdf.has_diffuse() && bsdf.sample_diffuse(point, s)) {
      const BsdfValue v = bsdf.evaluate(s.wi, Lobes::kDiffuse);
      if (v.diffuse_pdf > 0) sum += luminance(v.diffuse * bsdf.view_factor()) / v.diffuse_pdf;
    }
    if (!bsdf.has_specular() || !bsdf.sample_specular(u(0.5497004779), point, s)) continue;
    const double far = bsdf.solid() && !bsdf.same_side(s.wi) ? sqr(far_index) : 1.0;
    if (s.delta) {
      sum += far * luminance(s.weight);
    } else {
      const BsdfValue v = bsdf.evaluate(s.wi, Lobes::kSpecular);
      if (v.specular_pdf > 0) sum += far * luminance(v.specular) / v.specular_pdf;
    }
  }
  return sum / draws;
}

// Narrow lobes at grazing angles scatter a little light more than once, noisily: these are looked at a second time, for longer.
double settled_furnace(const SurfaceParameters& p, const glm::vec3& wo) {
  const double quick = furnace(p, wo, 10000);
  return std::fabs(quick - 1) < 0.7 * kEnergyBound ? quick : furnace(p, wo, 300000);
}

void expect_white(const SurfaceParameters& p, float degrees, bool below = false) {
  EXPECT_NEAR(settled_furnace(p, direction_at(degrees, below)), 1, kEnergyBound)
      << "alpha " << p.alpha << ", metal " << p.metal << ", glass " << p.glass << ", ior " << p.ior << ", " << degrees
      << " degrees" << (below ? " from inside" : "");
}

const float kRoughnesses[] = {0, 0.03f, 0.1f, 0.2f, 0.35f, 0.5f, 0.7f, 0.85f, 1};
const float kAngles[] = {0, 20, 45, 60, 75, 82, 88};

TEST(Energy, MetalsAndDielectricsKeepItAtEveryRoughnessAngleIndexAndMixture) {
  for (const float roughness : kRoughnesses)
    for (const float metal : {0.0f, 0.3f, 0.7f, 1.0f})
      for (const float ior : {1.0f, 1.33f, 1.5f, 2.4f}) {
        if (metal == 1 && ior != 1.5f) continue;  // metals have no index
        SurfaceParameters p = surface(roughness, metal, 0);
        set_index(p, ior);
        for (const float degrees : kAngles) expect_white(p, degrees);
      }
}

TEST(Energy, SolidGlassKeepsItFromBothSides) {
  for (const float ior : {1.1f, 1.33f, 1.5f, 1.9f, 2.4f}) {
    const GlassAlbedo albedo(ior);
    for (const float roughness : kRoughnesses) {
      SurfaceParameters p = surface(roughness, 0, 1);
      set_index(p, ior);
      p.thin = false;
      p.glass_albedo = &albedo;
      for (const float degrees : kAngles)
        for (const bool below : {false, true}) expect_white(p, degrees, below);
    }
  }
}

TEST(Energy, ThinGlassKeepsIt) {
  for (const float roughness : kRoughnesses) {
    SurfaceParameters p = surface(roughness, 0, 1);
    set_index(p, 1.5f);
    for (const float degrees : kAngles) expect_white(p, degrees);
  }
}

// What a specular factor or colour takes from the reflection goes through.
TEST(Energy, ThinGlassOfAnySpecularKeepsIt) {
  for (const float roughness : {0.0f, 0.3f, 0.7f, 1.0f})
    for (const float specular : {0.0f, 0.6f, 1.0f})
      for (const float color : {0.0f, 1.0f, 30.0f}) {
        SurfaceParameters p = surface(roughness, 0, 1);
        set_index(p, 1.5f);
        p.glass_specular = specular;
        p.glass_color = glm::vec3(color);
        SCOPED_TRACE(testing::Message() << "specular " << specular << ", colour " << color);
        for (const float degrees : {0.0f, 60.0f, 82.0f}) expect_white(p, degrees);
      }
}

TEST(Energy, CoatsKeepItOverEveryBase) {
  for (const float roughness : {0.0f, 0.2f, 0.7f})
    for (const float metal : {0.0f, 0.5f, 1.0f})
      for (const float coat_roughness : {0.0f, 0.1f, 0.4f, 1.0f}) {
        SurfaceParameters p = surface(roughness, metal, 0);
        set_index(p, 1.5f);
        p.coat = 0.8f;
        p.coat_alpha = sqr(coat_roughness);
        for (const float degrees : kAngles) expect_white(p, degrees);
      }
}

TEST(Energy, NoColouredSurfaceGivesMoreThanItGets) {
  for (const float roughness : kRoughnesses)
    for (const float metal : {0.0f, 0.5f, 1.0f}) {
      SurfaceParameters p = surface(roughness, metal, 0);
      set_index(p, 1.5f);
      p.diffuse *= glm::vec3(0.9f, 0.5f, 0.1f);
      p.metal_f0 = {0.9f, 0.5f, 0.1f};
      for (const float degrees : kAngles) EXPECT_LE(furnace(p, direction_at(degrees), 10000), 1 + kEnergyBound);
    }
}

// f(wo, wi) = f(wi, wo), and through an interface f / index^2 of the side that light goes to (Veach 1997, 5.2).
void expect_reciprocal(const SurfaceParameters& p) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const auto draw = [&] {
      glm::vec3 w;
      do w = {unit(random), unit(random), unit(random)};
      while (glm::dot(w, w) > 1 || std::fabs(w.z) < 0.02f * glm::length(w));
      return glm::normalize(w);
    };
    const glm::vec3 a = draw(), b = draw();
    if (p.glass == 0 && (a.z < 0 || b.z < 0)) continue;
    const auto value = [&](const glm::vec3& wo, const glm::vec3& wi) {
      const Bsdf bsdf(p, wo, kUp, kUp, kUp);
      const double index = wi.z < 0 && !p.thin ? p.ior : 1;
      return luminance(bsdf.seen(bsdf.evaluate(wi))) / std::fabs(wi.z) * index * index;
    };
    const double forth = value(a, b), back = value(b, a);
    EXPECT_NEAR(forth, back, 2e-3 * (forth + back) + 1e-5) << "alpha " << p.alpha << ", from z " << a.z << " to " << b.z;
  }
}

TEST(Energy, LightMayRunEitherWayThroughEverySurfaceButACoated) {
  const GlassAlbedo albedo(1.5f);
  for (const float roughness : {0.2f, 0.5f, 1.0f}) {
    for (const float metal : {0.0f, 0.4f, 1.0f}) {
      SurfaceParameters p = surface(roughness, metal, 0);
      set_index(p, 1.5f);
      p.metal_f0 = {0.9f, 0.6f, 0.3f};
      expect_reciprocal(p);
    }
    for (const bool thin : {true, false}) {
      SurfaceParameters p = surface(roughness, 0, 1);
      set_index(p, 1.5f);
      p.thin = thin;
      p.glass_albedo = &albedo;
      expect_reciprocal(p);
    }
  }
}

}  // namespace
}  // namespace vitrine::trace
