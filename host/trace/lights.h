// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Everything that next-event estimation can aim at in one pose: emissive triangles, punctual lights and the environment map,
// chosen in proportion to their power.
#pragma once

#include <vector>

#include "host/trace/alias_table.h"
#include "host/trace/environment_light.h"
#include "host/trace/world.h"

namespace vitrine::trace {

struct LightSample {
  glm::vec3 wi{0};        // unit, towards the light
  float distance = 0;     // infinite for the environment and directional lights
  glm::vec3 radiance{0};  // for punctual lights: irradiance at normal incidence
  float pdf = 0;          // per solid angle, with the choice of the light; for punctual lights its probability
  bool punctual = false;  // cannot be hit by a scattered ray
};

class Lights {
 public:
  explicit Lights(const World& world);

  bool empty() const { return choice_.empty(); }
  bool single() const { return choice_.size() == 1; }
  // One light, and one point of it, seen from `from`. False where it gives no light there.
  bool sample(const glm::vec3& from, float pick, const glm::vec2& u, LightSample& sample) const;
  // The density with which sample() finds a point of an emissive surface that a ray of `direction` met at `distance`.
  float surface_pdf(const Surface& surface, const glm::vec3& direction, float distance) const;
  float environment_pdf(const glm::vec3& direction) const;
  bool environment_sampled() const { return environment_index_ >= 0; }
  const EnvironmentLight& environment() const { return environment_; }
  // For tests: all power, in watts per unit of radiance.
  double total_power() const { return total_power_; }

 private:
  struct Emitter {
    glm::vec3 corner, edge1, edge2, normal;
    glm::vec3 radiance;  // without texture
    float area;
    int object, triangle;
    bool double_sided, textured;
  };
  struct Punctual {
    LightKind kind;
    glm::vec3 position, direction, intensity;
    float range, cone_scale, cone_offset;
  };
  void add_emitters(const World& world, std::vector<float>& powers);
  void add_punctual(const World& world, std::vector<float>& powers);
  bool sample_emitter(const Emitter& emitter, const glm::vec3& from, const glm::vec2& u, LightSample& sample) const;
  static bool sample_punctual(const Punctual& light, const glm::vec3& from, LightSample& sample);

  const World* world_;
  EnvironmentLight environment_;
  std::vector<Emitter> emitters_;
  std::vector<Punctual> punctual_;
  std::vector<std::vector<int>> emitter_of_triangle_;  // per object: empty, or an index (or -1) per triangle
  AliasTable choice_;                                  // emitters, then punctual lights, then the environment
  int environment_index_ = -1;
  double total_power_ = 0;
};

}  // namespace vitrine::trace
