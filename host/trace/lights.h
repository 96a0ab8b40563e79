// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Everything that next-event estimation can aim at in one pose: emissive triangles, punctual lights and the environment map.
// A light is chosen for the point that it is to light: what has a place by a tree (light_tree.h); directional lights and the
// environment beside it, each of the three in proportion to the irradiance that it would give the point without shadows.
#pragma once

#include <vector>

#include "host/trace/environment_light.h"
#include "host/trace/light_tree.h"
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

  bool empty() const { return count_ == 0; }
  bool single() const { return count_ == 1; }
  // How far before a light's surface a ray to it may end, so as not to meet it.
  float margin() const { return margin_; }

  // With which probability what has a place, directional lights and the environment are sampled: of sum 1, or all 0 where
  // nothing can light the receiver.
  struct Shares {
    float tree = 1, directional = 0, environment = 0;
  };
  // The lights as a receiver sees them: what all of its samples have in common.
  struct View {
    LightTree::View tree;
    Shares shares;
    const LightReceiver& receiver() const { return tree.receiver; }
  };
  View view(const LightReceiver& receiver) const {
    View view{tree_.view(receiver), {}};
    if (!directional_.empty() || environment_.sampled()) view.shares = shares(view.tree);
    return view;
  }
  // One light, and one point of it. False where it gives the receiver no light.
  bool sample(const View& view, float pick, const glm::vec2& u, LightSample& sample) const;
  // The density with which sample() finds a point of an emissive surface that a ray of `direction` from the receiver met at
  // `distance`. Negative: it is none of the lights, for no receiver.
  float surface_pdf(const LightReceiver& receiver, const Surface& surface, const glm::vec3& direction, float distance) const;
  float environment_pdf(const LightReceiver& receiver, const glm::vec3& direction) const;
  bool environment_sampled() const { return environment_.sampled(); }
  const EnvironmentLight& environment() const { return environment_; }

 private:
  // One cache line.
  struct alignas(64) Emitter {
    glm::vec3 corner, edge1, edge2;
    glm::vec3 front;   // the normal, as long as twice the area
    int32_t radiance;  // index into radiances_: without texture
    int32_t object, triangle;
    bool double_sided, textured, coated;
  };
  struct Punctual {
    LightKind kind;
    glm::vec3 position, direction, intensity;
    float range, cone_scale, cone_offset;
  };
  void add_emitters(const World& world, std::vector<LightBounds>& bounds);
  void add_punctual(const World& world, std::vector<LightBounds>& bounds);
  Shares shares(const LightTree::View& view) const;
  bool sample_placed(const LightTree::View& view, float pick, const glm::vec2& u, LightSample& sample) const;
  bool sample_emitter(const Emitter& emitter, const glm::vec3& from, const glm::vec2& u, LightSample& sample) const;
  static bool sample_punctual(const Punctual& light, const glm::vec3& from, LightSample& sample);
  bool sample_directional(const LightReceiver& receiver, float pick, LightSample& sample) const;
  float directional_irradiance(const LightReceiver& receiver) const;

  const World* world_;
  EnvironmentLight environment_;
  std::vector<Emitter> emitters_;
  std::vector<glm::vec3> radiances_;  // that some emitters have in common
  std::vector<Punctual> punctual_;  // points and spots
  std::vector<Punctual> directional_;
  std::vector<std::vector<int>> emitter_of_triangle_;  // per object: empty, or an index (or -1) per triangle
  LightTree tree_;                                     // emitters, then points and spots
  size_t count_ = 0;
  float margin_ = 0;
};

}  // namespace vitrine::trace
