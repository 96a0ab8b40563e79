// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The environment as a light: radiance by direction, and for maps a piecewise constant density over a lat-long grid of its own,
// proportional to luminance times solid angle. (The grid asks Environment::lookup, so it shares no convention with the file.)
// A constant environment is not sampled as a light: following scattered rays finds it with less noise.
#pragma once

#include "host/scene/scene.h"
#include "host/trace/alias_table.h"
#include "host/trace/vector_math.h"

namespace vitrine::trace {

class EnvironmentLight {
 public:
  explicit EnvironmentLight(const Environment& environment);
  glm::vec3 radiance(const glm::vec3& direction) const {
    return constant_ ? constant_radiance_ : environment_->lookup(direction);
  }
  bool sampled() const { return !table_.empty(); }
  float mean_luminance() const { return mean_luminance_; }  // over the sphere
  // A unit direction towards the environment and its density per solid angle.
  glm::vec3 sample(float pick, const glm::vec2& u, float& pdf) const;
  float pdf(const glm::vec3& direction) const;

 private:
  float cosine_of_row(int row) const;  // of the polar angle, at the row's upper border
  float density(int cell) const;
  const Environment* environment_;
  bool constant_ = true;
  glm::vec3 constant_radiance_{0};
  float mean_luminance_ = 0;
  int columns_ = 0, rows_ = 0;
  AliasTable table_;
};

}  // namespace vitrine::trace
