// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What the dials move: animations, orbits, lamps, switches.
#include "host/scene/axes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "tests/scene/scene_files.h"

namespace vitrine {
namespace {

using nlohmann::json;
using test::Folder;
using test::Model;

constexpr float kDegree = std::numbers::pi_v<float> / 180;

Position at(float a, float b = 0) { return Position{a, b, 0, 0}; }

using test::expect_near;

void add_animation(Model& m, const char* path, const char* interpolation, const std::vector<float>& times,
                   const std::vector<float>& values, size_t components) {
  const int input = m.add_floats(times, 1), output = m.add_floats(values, components);
  m.json["animations"] = {{{"name", "move"},
                           {"samplers", {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}}};
}

const char* kMoveAxis = "[[axis]]\nname = \"move\"\nanimation = \"move\"\nsamples = 5\n";

glm::mat4 object_at(const Scene& scene, float position) { return world_from_object(scene, pose_scene(scene, at(position)), 0); }

TEST(AnimationAxis, LinearKeysAreMetAtTheirShareOfTheLastTime) {
  Model m = Model::triangle();
  add_animation(m, "translation", "LINEAR", {1, 2, 4}, {0, 0, 0, 8, 0, 0, 8, 4, 0}, 3);  // seconds 1, 2, 4 of [0, 4]
  const Folder folder;
  const auto scene = test::load(folder, m, kMoveAxis);
  expect_near(object_at(*scene, 0)[3], {0, 0, 0});
  expect_near(object_at(*scene, 0.25f)[3], {0, 0, 0});
  expect_near(object_at(*scene, 0.375f)[3], {4, 0, 0});
  expect_near(object_at(*scene, 0.5f)[3], {8, 0, 0});
  expect_near(object_at(*scene, 0.75f)[3], {8, 2, 0});
  expect_near(object_at(*scene, 1)[3], {8, 4, 0});
}

TEST(AnimationAxis, StepsJump) {
  Model m = Model::triangle();
  add_animation(m, "translation", "STEP", {0, 1, 2}, {0, 0, 0, 1, 0, 0, 2, 0, 0}, 3);
  const Folder folder;
  const auto scene = test::load(folder, m, kMoveAxis);
  expect_near(object_at(*scene, 0.49f)[3], {0, 0, 0});
  expect_near(object_at(*scene, 0.51f)[3], {1, 0, 0});
}

// Hermite: p(t) with p0 = 0, p1 = 1 and end slopes 3 and -1 per second over 2 seconds (glTF 2.0, appendix C.5).
TEST(AnimationAxis, CubicTangentsArePerSecondWhateverTheDuration) {
  Model m = Model::triangle();
  add_animation(m, "translation", "CUBICSPLINE", {0, 2}, {0, 0, 0, 0, 0, 0, 3, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0}, 3);
  const Folder folder;
  const auto scene = test::load(folder, m, kMoveAxis);
  for (const float t : {0.0f, 0.25f, 0.5f, 0.9f, 1.0f}) {
    const float t2 = t * t, t3 = t2 * t;
    const float expected = (t3 - 2 * t2 + t) * 2 * 3 + (-2 * t3 + 3 * t2) * 1 + (t3 - t2) * 2 * -1;
    expect_near(object_at(*scene, t)[3], {expected, 0, 0}, 1e-5f);
  }
}

TEST(AnimationAxis, RotationsTurnEvenly) {
  Model m = Model::triangle();
  const float s = std::sin(45 * kDegree), c = std::cos(45 * kDegree);
  add_animation(m, "rotation", "LINEAR", {0, 1}, {0, 0, 0, 2, 0, 2 * s, 0, 2 * c}, 4);  // 90 degrees about Y, not of unit length
  const Folder folder;
  const auto scene = test::load(folder, m, kMoveAxis);
  for (const float t : {0.0f, 0.3f, 0.5f, 1.0f})
    expect_near(glm::vec3(object_at(*scene, t) * glm::vec4(0, 0, 1, 0)),
                {std::sin(90 * t * kDegree), 0, std::cos(90 * t * kDegree)});
}

TEST(AnimationAxis, TwoAxesOnOnePathAreAnError) {
  Model m = Model::triangle();
  add_animation(m, "translation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0}, 3);
  m.json["animations"].push_back(m.json["animations"][0]);
  m.json["animations"][1]["name"] = "again";
  const Folder folder;
  const std::string error = test::error_of(
      [&] { test::load(folder, m, std::string(kMoveAxis) + "[[axis]]\nname = \"b\"\nanimation = \"again\"\nsamples = 2\n"); });
  EXPECT_NE(error.find("axis 2 (\"b\"): it moves node \"thing\" on a path that another axis moves already"), std::string::npos)
      << error;
}

TEST(Orbit, CameraStandsWhereTheCircleSaysAndLooksAtTheTarget) {
  const Folder folder;
  const auto scene = test::load(
      folder, Model::triangle(),
      "[[axis]]\nname = \"view\"\norbit = { target = [1, 2, 3], radius = 4, height = 3, from = -30, to = 250 }\nsamples = 9\n");
  for (int k = 0; k <= 20; ++k) {
    const float t = static_cast<float>(k) / 20, angle = (-30 + 280 * t) * kDegree;
    const glm::mat4 camera = pose_scene(*scene, at(t)).world_from_camera;
    const glm::vec3 eye(camera[3]), expected(1 + 4 * std::sin(angle), 2 + 3, 3 + 4 * std::cos(angle));
    expect_near(eye, expected, 2e-5f);
    expect_near(-glm::vec3(camera[2]), glm::normalize(glm::vec3(1, 2, 3) - eye), 2e-6f);
    EXPECT_NEAR(camera[0].y, 0, 1e-6) << "the horizon stays level";
    EXPECT_GT(camera[1].y, 0) << "up stays up";
  }
  EXPECT_EQ(camera_axes(*scene), 1u);
  EXPECT_EQ(geometry_axes(*scene), 1u);
  EXPECT_NEAR(scene->camera.yfov, 40 * kDegree, 1e-6);
}

TEST(Orbit, PeriodicOrbitClosesAndAnUnclosedOneWarns) {
  const Folder folder;
  const auto closed =
      test::load(folder, Model::triangle(),
                 "[[axis]]\nname = \"view\"\norbit = { from = 0, to = 360, yfov = 25 }\nsamples = 8\nkind = \"periodic\"\n");
  EXPECT_TRUE(closed->warnings.empty());
  expect_near(pose_scene(*closed, at(0)).world_from_camera[3], pose_scene(*closed, at(1)).world_from_camera[3], 1e-5f);
  EXPECT_NEAR(closed->camera.yfov, 25 * kDegree, 1e-6);
  const auto open = test::load(folder, Model::triangle(),
                               "[[axis]]\nname = \"view\"\norbit = { from = 0, to = 350 }\nsamples = 8\nkind = \"periodic\"\n");
  ASSERT_EQ(open->warnings.size(), 1u);
  EXPECT_NE(open->warnings[0].find("multiple of 360 degrees"), std::string::npos);
}

TEST(Lamp, TravelsOnItsArcWithTheRadianceItWasGiven) {
  const Folder folder;
  const auto scene = test::load(folder, Model::triangle(),
                                "[[axis]]\nname = \"lamp\"\nlamp = { target = [0, 1, 0], radius = 2, elevation = 30, from = 0, "
                                "to = 90, size = 0.5, color = [1, 0.5, 0], strength = 10 }\nsamples = 4\n");
  ASSERT_EQ(scene->objects.size(), 2u);
  const Object& lamp = scene->objects[1];
  EXPECT_EQ(lamp.name, "lamp");
  for (const glm::vec3& p : lamp.geometry.positions) EXPECT_NEAR(glm::length(p), 0.25f, 1e-6);
  EXPECT_EQ(scene->materials[static_cast<size_t>(lamp.geometry.triangle_materials[0])].emissive, glm::vec3(10, 5, 0));
  for (const float t : {0.0f, 1 / 3.0f, 1.0f}) {
    const glm::vec3 p(world_from_object(*scene, pose_scene(*scene, at(t)), 1)[3]);
    const float r = 2 * std::cos(30 * kDegree);
    expect_near(p, {r * std::sin(90 * t * kDegree), 1 + 2 * std::sin(30 * kDegree), r * std::cos(90 * t * kDegree)});
  }
  EXPECT_EQ(camera_axes(*scene), 0u);
  EXPECT_EQ(geometry_axes(*scene), 1u);
}

Model room_with_lights() {
  Model m = Model::triangle();
  m.json["materials"].push_back({{"name", "glow"}, {"emissiveFactor", {1, 1, 1}}});
  m.json["meshes"].push_back(m.json["meshes"][0]);
  m.json["meshes"][1]["primitives"][0]["material"] = 1;
  m.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  m.json["nodes"] = {{{"name", "thing"}, {"mesh", 0}},
                     {{"name", "tube"}, {"mesh", 1}},
                     {{"name", "fixture"}, {"children", {3}}},
                     {{"name", "fixture light"}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}},
                     {{"name", "always"}, {"mesh", 1}}};
  m.json["scenes"][0]["nodes"] = {0, 1, 2, 4};
  return m;
}

TEST(LightsSwitch, NamedEmittersObeyAndOthersStayOn) {
  const Folder folder;
  const auto scene =
      test::load(folder, room_with_lights(), "[[axis]]\nname = \"lights\"\nlights = [[\"tube\"], [\"tube\", \"fixture\"], []]\n");
  ASSERT_EQ(scene->axes.size(), 1u);
  EXPECT_EQ(scene->axes[0].shape.kind, AxisKind::kDiscrete);
  EXPECT_EQ(scene->axes[0].shape.samples, 3);
  EXPECT_EQ(scene->axes[0].value_names, (std::vector<std::string>{"tube", "tube, fixture", "off"}));
  const float tube[] = {1, 1, 0}, fixture[] = {0, 1, 0};
  for (int v = 0; v < 3; ++v) {
    const Pose pose = pose_scene(*scene, at(v / 2.0f));
    EXPECT_EQ(pose.object_emission, (std::vector<float>{1, tube[v], 1})) << "value " << v;
    EXPECT_EQ(pose.light_emission, std::vector<float>{fixture[v]}) << "a light below the named node is switched with it";
  }
  EXPECT_EQ(geometry_axes(*scene), 0u);
}

TEST(LightsSwitch, OneEmitterHasOneSwitch) {
  const Folder folder;
  const std::string axis = "lights = [[\"tube\"], []]\n";
  const std::string error = test::error_of(
      [&] { test::load(folder, room_with_lights(), "[[axis]]\nname = \"a\"\n" + axis + "[[axis]]\nname = \"b\"\n" + axis); });
  EXPECT_NE(error.find("\"tube\" is switched twice"), std::string::npos) << error;
}

TEST(VariantsSwitch, PoseChoosesTheMaterials) {
  Model m = Model::triangle();
  m.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "plain"}, {"x", 1}}, {{"name", "gold"}}};
  m.json["materials"].push_back({{"name", "gold paint"}});
  m.primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {1}}}};
  const Folder folder;
  const auto scene = test::load(folder, m, "[[axis]]\nname = \"finish\"\nvariants = [\"plain\", \"gold\"]\n");
  EXPECT_EQ(scene->variant_axis, 0);
  const auto name_at = [&](float p) {
    const Pose pose = pose_scene(*scene, at(p));
    return scene->materials[static_cast<size_t>(material_of(scene->objects[0], pose, 0))].name;
  };
  EXPECT_EQ(name_at(0), "paint");
  EXPECT_EQ(name_at(1), "gold paint");
}

TEST(ObjectEntries, OverrideWhatTheLoaderChose) {
  const Folder folder;
  const auto scene = test::load(folder, Model::triangle(),
                                "[[object]]\nnode = \"thing\"\nresolution_scale = 1.5\n[target]\nstorage = \"12 "
                                "MB\"\ninterpolate = true\nbetween = true\nexposure = 2\n");
  EXPECT_EQ(scene->objects[0].resolution_scale, 1.5f);
  EXPECT_EQ(scene->settings.storage, "12 MB");
  EXPECT_TRUE(scene->settings.interpolate);
  EXPECT_TRUE(scene->settings.between);
  EXPECT_EQ(scene->settings.exposure, 2);
  const auto dome = test::load(folder, Model::triangle(),
                               "environment = [1, 1, 1]\n[[object]]\nnode = \"background\"\nresolution_scale = 0.5\n");
  EXPECT_EQ(dome->objects[1].resolution_scale, 0.5f);
}

}  // namespace
}  // namespace vitrine
