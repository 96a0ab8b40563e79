// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/axis_smoothing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace vitrine {
namespace {

constexpr int kViews = 5, kLamps = 3;

ParameterSpace two_axes(AxisKind lamp = AxisKind::kLinear) {
  ParameterSpace space;
  space.axis_count = 2;
  space.axes[0] = {AxisKind::kLinear, 20};
  space.axes[1] = {lamp, kLamps};
  return space;
}
constexpr FieldShape::Box kBox{{7, 0}, {7 + kViews - 1, kLamps - 1}};

std::vector<SolvedTexture> random_textures(size_t texels, float precision) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any(0, 1);
  std::vector<SolvedTexture> textures(kViews * kLamps);
  for (SolvedTexture& t : textures) {
    for (size_t i = 0; i < texels; ++i) t.texels.emplace_back(any(random), any(random), any(random));
    t.precision.assign(texels, precision);
  }
  return textures;
}

double energy(const std::vector<SolvedTexture>& from, const std::vector<SolvedTexture>& to, float strength, size_t texel) {
  double sum = 0;
  const auto square = [](const glm::vec3& d) { return static_cast<double>(d.x * d.x + d.y * d.y + d.z * d.z); };
  for (int v = 0; v < kViews; ++v)
    for (int l = 0; l < kLamps; ++l) {
      const size_t s = static_cast<size_t>(v * kLamps + l);
      const glm::vec3 x = to[s].texels[texel];
      sum += static_cast<double>(from[s].precision[texel]) * square(x - from[s].texels[texel]);
      if (v + 1 < kViews) sum += static_cast<double>(strength) * square(x - to[s + kLamps].texels[texel]);
      if (l + 1 < kLamps) sum += static_cast<double>(strength) * square(x - to[s + 1].texels[texel]);
    }
  return sum;
}

TEST(AxisSmoothing, WhatNoSampleButOneSeesIsTheSameInAll) {
  auto textures = random_textures(300, 0);
  textures[4].precision[170] = 1;
  const glm::vec3 seen = textures[4].texels[170];
  smooth_over_axes(two_axes(), kBox, 1, textures);
  for (const SolvedTexture& t : textures)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(t.texels[170][c], seen[c], 0.05f);
}

// At the strength that scenes have, not to be drawn to the black that inference leaves.
TEST(AxisSmoothing, ASampleThatSeesNothingTakesWhatOthersKnow) {
  auto textures = random_textures(4, 0);
  for (SolvedTexture& t : textures) {
    t.texels.assign(4, glm::vec3(0));
    t.hold = SolvedTexture::kHoldUnseen;
  }
  textures[7].texels.assign(4, glm::vec3(1));
  textures[7].precision.assign(4, 1);
  textures[7].hold = SolvedTexture::kHold;
  smooth_over_axes(two_axes(), kBox, 0.01f, textures);
  for (const SolvedTexture& t : textures) EXPECT_NEAR(t.texels[2].x, 1, 0.01f);
}

TEST(AxisSmoothing, WhatThePictureDeterminesStays) {
  const auto inferred = random_textures(40, 1);
  auto textures = inferred;
  smooth_over_axes(two_axes(), kBox, 0.001f, textures);
  for (size_t s = 0; s < textures.size(); ++s)
    for (size_t i = 0; i < 40; ++i)
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(textures[s].texels[i][c], inferred[s].texels[i][c], 0.005f);
}

// No change of a single value lowers what is to be minimized.
TEST(AxisSmoothing, ItIsTheLeastOfItsEnergy) {
  const auto inferred = random_textures(8, 0.3f);
  auto textures = inferred;
  smooth_over_axes(two_axes(), kBox, 0.2f, textures);
  for (size_t i = 0; i < 8; ++i) {
    const double least = energy(inferred, textures, 0.2f, i);
    EXPECT_LT(least, energy(inferred, inferred, 0.2f, i));
    for (size_t s = 0; s < textures.size(); ++s)
      for (const float step : {0.02f, -0.02f}) {
        auto moved = textures;
        moved[s].texels[i].x += step;
        EXPECT_GT(energy(inferred, moved, 0.2f, i), least) << "texel " << i << ", sample " << s;
      }
  }
}

TEST(AxisSmoothing, PositionsOfASwitchAreNotMixed) {
  auto textures = random_textures(10, 0);
  for (int v = 0; v < kViews; ++v)
    for (int l = 0; l < kLamps; ++l) {
      SolvedTexture& t = textures[static_cast<size_t>(v * kLamps + l)];
      t.texels.assign(10, glm::vec3(l));
      t.precision.assign(10, v == 0 ? 1.0f : 0.0f);
    }
  smooth_over_axes(two_axes(AxisKind::kDiscrete), kBox, 1, textures);
  for (size_t s = 0; s < textures.size(); ++s) EXPECT_NEAR(textures[s].texels[3].x, static_cast<float>(s % kLamps), 1e-5f);
}

}  // namespace
}  // namespace vitrine
