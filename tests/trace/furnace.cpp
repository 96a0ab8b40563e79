// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// In an environment of radiance 1 from everywhere, a surface that loses nothing looks like the environment.
#include <gtest/gtest.h>

#include "tests/trace/measure.h"
#include "tests/trace/scenes.h"

namespace vitrine::test {
namespace {

constexpr double kEnergySlack = 0.005;  // of one
constexpr double kDepthSlack = 1e-4;    // single precision over many bounces

Laboratory::Radiance plate(const Material& material, float degrees) {
  Scene scene = scene_with_camera({0, 0, 5}, {0, 0, 0}, 0.5f);
  set_environment(scene, glm::vec3(1));
  add_object(scene, make_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), add_material(scene, material), "plate");
  const float a = glm::radians(degrees);
  return Laboratory(scene).look({std::sin(a), 0, std::cos(a)}, {-std::sin(a), 0, -std::cos(a)}, 16, 256);
}

TEST(Furnace, WhiteWallStaysWhite) {
  for (const float degrees : {0.0f, 45.0f, 85.0f}) EXPECT_ESTIMATE(plate(lambert(glm::vec3(1)), degrees).sum, 1, kDepthSlack);
}

TEST(Furnace, WhiteMetalStaysWhiteAtEveryRoughness) {
  for (const float roughness : {0.0f, 0.05f, 0.15f, 0.3f, 0.5f, 0.75f, 1.0f}) {
    for (const float degrees : {0.0f, 40.0f, 75.0f, 85.0f}) {
      SCOPED_TRACE(testing::Message() << "roughness " << roughness << ", " << degrees << " degrees");
      EXPECT_ESTIMATE(plate(metal(glm::vec3(1), roughness), degrees).sum, 1, kEnergySlack);
    }
  }
}

TEST(Furnace, ClearPaneIsInvisible) {
  for (const float roughness : {0.0f, 0.3f, 0.7f, 1.0f}) {
    for (const float degrees : {0.0f, 60.0f}) {
      SCOPED_TRACE(testing::Message() << "roughness " << roughness << ", " << degrees << " degrees");
      EXPECT_ESTIMATE(plate(clear_glass(1.5f, roughness, 0), degrees).sum, 1, kEnergySlack);
    }
  }
}

TEST(Furnace, ClearBallIsInvisible) {
  for (const float roughness : {0.0f, 0.2f, 0.5f, 0.8f}) {
    SCOPED_TRACE(testing::Message() << "roughness " << roughness);
    Scene scene = scene_with_camera({0, 0, 5}, {0, 0, 0}, 0.5f);
    set_environment(scene, glm::vec3(1));
    add_object(scene, make_sphere({0, 0, 0}, 1), add_material(scene, clear_glass(1.5f, roughness, 1)), "ball");
    // Beyond the tables: facets of the tessellation reject the few directions that leave on their wrong side.
    EXPECT_ESTIMATE(Laboratory(scene).look({0.3f, 0.2f, 3}, {0, 0, -1}, 16, 128).sum, 1, 2 * kEnergySlack);
  }
}

TEST(Furnace, WhitePlasticAndCoatedWallStayWhiteFromEverywhere) {
  for (const float coat : {0.0f, 1.0f})
    for (const float roughness : {0.0f, 0.3f, 0.8f})
      for (const float degrees : {0.0f, 30.0f, 60.0f, 80.0f}) {
        SCOPED_TRACE(testing::Message() << "coat " << coat << ", roughness " << roughness << ", " << degrees << " degrees");
        Material plastic;
        plastic.metallic = 0;
        plastic.roughness = roughness;
        plastic.clearcoat = coat;
        plastic.clearcoat_roughness = 0.1f;
        EXPECT_ESTIMATE(plate(plastic, degrees).sum, 1, kEnergySlack);
      }
}

TEST(Furnace, DiffuseLayerDoesNotDependOnTheView) {
  Material plastic;
  plastic.metallic = 0;
  plastic.roughness = 0.4f;
  plastic.base_color = {0.7f, 0.5f, 0.3f, 1};
  const Estimate head_on = plate(plastic, 5).diffuse, grazing = plate(plastic, 80).diffuse;
  EXPECT_NEAR(head_on.mean, grazing.mean, 4 * std::hypot(head_on.error, grazing.error) + kDepthSlack);
}

// A map of radiance 1 is sampled as a light, other than a constant, so here light that goes straight through glass is weighed.
void set_map_of_ones(Scene& scene) {
  scene.environment.width = 16;
  scene.environment.height = 8;
  scene.environment.radiance.assign(16 * 8, glm::vec3(1));
}

// Straight lines lose what glass reflects of the light that they stand for, and what it reflects within comes on top.
constexpr double kThroughGlassSlack = 0.12;

TEST(Furnace, WhatGlassStandsOnGetsItsLightOnce) {
  for (const bool box : {false, true}) {
    SCOPED_TRACE(box ? "box" : "ball");
    Scene scene = scene_with_camera({0, 0, 5}, {0, 0, 0}, 0.5f);
    set_map_of_ones(scene);
    add_object(scene, make_quad({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}), add_material(scene, lambert(glm::vec3(1))), "floor");
    Geometry glass = box ? make_box({-0.5f, -0.5f, 0.001f}, {0.5f, 0.5f, 1}) : make_sphere({0, 0, 0.501f}, 0.5f);
    add_object(scene, std::move(glass), add_material(scene, clear_glass(1.5f, 0, 1)), "glass");
    for (const glm::vec3& from : {glm::vec3(0.1f, 0.2f, 4), glm::vec3(2, 1, 3)}) {
      EXPECT_ESTIMATE(Laboratory(scene).look(from, glm::vec3(0.05f, 0.1f, 0.3f) - from, 16, 256).sum, 1, kThroughGlassSlack);
    }
  }
}

TEST(Furnace, WhatStandsInsideOfGlassGetsItsLight) {
  Scene scene = scene_with_camera({0, 0, 5}, {0, 0, 0}, 0.5f);
  set_map_of_ones(scene);
  add_object(scene, make_sphere({0, 0, 0}, 0.5f), add_material(scene, lambert(glm::vec3(1))), "inner");
  add_object(scene, make_sphere({0, 0, 0}, 1), add_material(scene, clear_glass(1.5f, 0, 1)), "glass");
  EXPECT_ESTIMATE(Laboratory(scene).look({0.1f, 0.2f, 4}, {0, 0, -1}, 16, 256).sum, 1, 2 * kEnergySlack);
}

}  // namespace
}  // namespace vitrine::test
