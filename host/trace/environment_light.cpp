// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/environment_light.h"

namespace vitrine::trace {
namespace {

// The cosine of the angle from +Y; phi about +Y in [0, 2 pi).
glm::vec3 direction_of(float cosine, float phi) {
  const float s = safe_sqrt(1 - cosine * cosine);
  return {s * std::sin(phi), cosine, s * std::cos(phi)};
}

}  // namespace

EnvironmentLight::EnvironmentLight(const Environment& environment) : environment_(&environment) {
  const int64_t texels = static_cast<int64_t>(environment.width) * environment.height;
  if (texels <= 0 || environment.radiance.empty()) return;
  if (texels == 1) {
    constant_radiance_ = environment.radiance[0];
    mean_luminance_ = luminance(constant_radiance_);
    return;
  }
  constant_ = false;
  columns_ = std::clamp(environment.width, 16, 1024);
  rows_ = std::clamp(environment.height, 8, 512);
  std::vector<float> weights(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
  double sum = 0, solid_angle = 0;
  for (int y = 0; y < rows_; ++y) {
    const float sin_theta = std::sin(kPi * (static_cast<float>(y) + 0.5f) / static_cast<float>(rows_));
    for (int x = 0; x < columns_; ++x) {
      float mean = 0;
      for (int s = 0; s < 4; ++s) {  // 2 x 2 points of the cell
        const float theta = kPi * (static_cast<float>(y) + 0.25f + 0.5f * static_cast<float>(s / 2)) / static_cast<float>(rows_);
        const float phi =
            2 * kPi * (static_cast<float>(x) + 0.25f + 0.5f * static_cast<float>(s % 2)) / static_cast<float>(columns_);
        mean += 0.25f * luminance(environment.lookup(direction_of(std::cos(theta), phi)));
      }
      weights[static_cast<size_t>(y * columns_ + x)] = mean * sin_theta;
      sum += mean * sin_theta;
      solid_angle += sin_theta;
    }
  }
  mean_luminance_ = static_cast<float>(sum / solid_angle);
  if (!(sum > 0)) return;
  // A floor keeps the density positive wherever interpolation could carry light.
  for (size_t i = 0; i < weights.size(); ++i) {
    const float sin_theta =
        std::sin(kPi * (static_cast<float>(i / static_cast<size_t>(columns_)) + 0.5f) / static_cast<float>(rows_));
    weights[i] += 0.02f * mean_luminance_ * sin_theta;
  }
  table_ = AliasTable(weights);
}

float EnvironmentLight::cosine_of_row(int row) const {
  return std::cos(kPi * static_cast<float>(row) / static_cast<float>(rows_));
}

float EnvironmentLight::density(int cell) const {
  const int row = cell / columns_;
  const float solid_angle = 2 * kPi / static_cast<float>(columns_) * (cosine_of_row(row) - cosine_of_row(row + 1));
  return table_.probability(cell) / solid_angle;
}

glm::vec3 EnvironmentLight::sample(float pick, const glm::vec2& u, float& pdf) const {
  const int cell = table_.sample(pick);
  const float above = cosine_of_row(cell / columns_), below = cosine_of_row(cell / columns_ + 1);
  const float phi = 2 * kPi * (static_cast<float>(cell % columns_) + u.x) / static_cast<float>(columns_);
  pdf = density(cell);
  return direction_of(above + u.y * (below - above), phi);
}

float EnvironmentLight::pdf(const glm::vec3& direction) const {
  const float theta = std::acos(std::clamp(direction.y, -1.0f, 1.0f));
  const float phi = std::atan2(direction.x, direction.z);
  const int y = std::clamp(static_cast<int>(theta / kPi * static_cast<float>(rows_)), 0, rows_ - 1);
  const float wrapped = (phi < 0 ? phi + 2 * kPi : phi) / (2 * kPi);
  const int x = std::clamp(static_cast<int>(wrapped * static_cast<float>(columns_)), 0, columns_ - 1);
  return density(y * columns_ + x);
}

}  // namespace vitrine::trace
