// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Cameras, depth ranges, the backdrop, and the scene that `vitrine new` makes.
#include "host/scene/framing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_inverse.hpp>
#include <set>

#include "host/scene/environment.h"
#include "host/scene/new_scene.h"
#include "host/scene/shapes.h"
#include "tests/scene/scene_files.h"

namespace vitrine {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::Folder;
using test::Model;

std::vector<Position> grid_of(const Scene& scene) {
  std::vector<Position> positions;
  const ParameterSpace space = scene.space();
  for (int64_t i = 0; i < space.sample_count(); ++i) positions.push_back(space.position_of(space.index_from_flat(i)));
  return positions;
}

// Every vertex of every object lies between near and far, the dome behind all others.
void expect_depth_holds(const Scene& scene) {
  EXPECT_LE(scene.camera.far_distance / scene.camera.near_distance, 10001);
  for (const Position& position : grid_of(scene)) {
    const Pose pose = pose_scene(scene, position);
    const glm::vec3 eye(pose.world_from_camera[3]);
    float farthest = 0;
    for (size_t o = 0; o < scene.objects.size(); ++o) {
      const glm::mat4 world = world_from_object(scene, pose, static_cast<int>(o));
      for (const uint32_t i : scene.objects[o].geometry.indices) {
        const float distance = glm::distance(eye, glm::vec3(world * glm::vec4(scene.objects[o].geometry.positions[i], 1)));
        ASSERT_LT(distance, scene.camera.far_distance);
        ASSERT_GT(distance, scene.camera.near_distance);
        if (!scene.objects[o].follows_camera) farthest = std::max(farthest, distance);
      }
    }
    if (scene.background_object >= 0) {
      const Geometry& dome = scene.objects.back().geometry;
      for (size_t t = 0; t + 2 < dome.indices.size(); t += 3) {
        const glm::vec3 a = dome.positions[dome.indices[t]], b = dome.positions[dome.indices[t + 1]], c = dome.positions[dome.indices[t + 2]];
        const float plane = std::abs(glm::dot(glm::normalize(glm::cross(b - a, c - a)), a));
        ASSERT_GT(plane, farthest) << "the dome cuts through the scene";
      }
    }
  }
}

TEST(Camera, ComesFromTheModelByNameOrTheFirst) {
  Model m = Model::triangle();
  m.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 1}}}},
                       {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 2}, {"znear", 0}, {"zfar", 1}}}}};
  m.json["nodes"].push_back({{"name", "front"}, {"camera", 0}, {"translation", {0, 0, 5}}});
  m.json["nodes"].push_back({{"name", "plan"}, {"camera", 1}, {"translation", {0, 5, 0}}});
  m.json["scenes"][0]["nodes"] = {0, 1, 2};
  const Folder folder;
  auto scene = test::load(folder, m);
  EXPECT_FLOAT_EQ(scene->camera.yfov, 0.5f);
  EXPECT_EQ(glm::vec3(pose_scene(*scene, {}).world_from_camera[3]), glm::vec3(0, 0, 5));
  scene = test::load(folder, m, "camera = \"plan\"\n");
  EXPECT_FALSE(scene->camera.perspective);
  EXPECT_FLOAT_EQ(scene->camera.ymag, 2);
  const std::string error = test::error_of([&] { test::load(folder, m, "camera = \"side\"\n"); });
  EXPECT_NE(error.find("there is no camera \"side\": there are front, plan"), std::string::npos) << error;
}

TEST(Camera, ScaledNodeLeavesTheCameraRigid) {
  Model m = Model::triangle();
  m.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 1}}}}};
  m.json["nodes"] = {{{"name", "cm"}, {"scale", {0.01, 0.01, 0.01}}, {"children", {1, 2}}},
                     {{"mesh", 0}},
                     {{"camera", 0}, {"translation", {0, 0, 500}}}};
  const Folder folder;
  const auto scene = test::load(folder, m);
  const glm::mat4 camera = pose_scene(*scene, {}).world_from_camera;
  EXPECT_NEAR(camera[3].z, 5, 1e-5);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(glm::length(glm::vec3(camera[c])), 1, 1e-5);
  expect_depth_holds(*scene);
  m.json["nodes"][0]["scale"] = {0.01, 0.02, 0.01};
  EXPECT_NE(test::error_of([&] { test::load(folder, m); }).find("the camera's node is stretched or mirrored"), std::string::npos);
}

TEST(Camera, FittedOneSeesTheWholeModelAndSaysSo) {
  const Folder folder;
  const auto scene = test::load(folder, Model::triangle());
  ASSERT_EQ(scene->warnings.size(), 1u);
  EXPECT_NE(scene->warnings[0].find("the view is fitted to the model"), std::string::npos);
  const glm::mat4 clip = clip_from_camera(scene->camera, 640 / 480.0f) * glm::inverse(pose_scene(*scene, {}).world_from_camera);
  for (const glm::vec3& p : scene->objects[0].geometry.positions) {
    const glm::vec4 c = clip * glm::vec4(p, 1);
    EXPECT_LT(std::max(std::abs(c.x), std::abs(c.y)), c.w);
  }
}

TEST(Depth, HoldsTheSceneOverTheWholeMotion) {
  const Folder folder;
  const auto scene = test::load(folder, Model::triangle(),
                                "environment = [1, 1, 1]\n[[axis]]\nname = \"view\"\norbit = { radius = 3, height = 1 }\nsamples "
                                "= 9\n[[axis]]\nname = \"lamp\"\nlamp = { radius = 9 }\nsamples = 3\n");
  expect_depth_holds(*scene);
  EXPECT_GT(scene->camera.near_distance, 0.5f) << "an empty space before the camera is not wasted";
}

TEST(Backdrop, IsADomeThatFacesInwardsWithLatLongCoordinates) {
  const Folder folder;
  const auto scene = test::load(folder, Model::triangle(), "environment = [1, 2, 3]\n");
  ASSERT_EQ(scene->background_object, 1);
  const Object& dome = scene->objects[1];
  EXPECT_EQ(dome.name, "background");
  EXPECT_TRUE(dome.follows_camera);
  EXPECT_TRUE(scene->background_is_environment);
  EXPECT_TRUE(scene->materials[static_cast<size_t>(dome.geometry.triangle_materials[0])].unlit);
  const Geometry& g = dome.geometry;
  EXPECT_EQ(g.indices.size() / 3, 2u * 48 * 24 - 2 * 48);
  double solid_angle = 0;
  for (size_t t = 0; t < g.indices.size(); t += 3) {
    const glm::vec3 a = glm::normalize(g.positions[g.indices[t]]), b = glm::normalize(g.positions[g.indices[t + 1]]),
                    c = glm::normalize(g.positions[g.indices[t + 2]]);
    EXPECT_LT(glm::dot(glm::cross(b - a, c - a), a + b + c), 0) << "faces outwards";
    solid_angle -= 2 * std::atan2(glm::dot(a, glm::cross(b, c)), 1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
    for (int k = 0; k < 3; ++k) {
      const glm::vec3 d = glm::normalize(g.positions[g.indices[t + static_cast<size_t>(k)]]);
      if (std::abs(d.y) > 0.999f) continue;
      const glm::vec2 uv = g.texcoords[0][g.indices[t + static_cast<size_t>(k)]], expected = latlong_from_direction(d);
      EXPECT_NEAR(std::abs(uv.x - expected.x), uv.x < 1e-6f || uv.x > 1 - 1e-6f ? std::round(std::abs(uv.x - expected.x)) : 0,
                  1e-5);
      EXPECT_NEAR(uv.y, expected.y, 1e-5);
    }
  }
  EXPECT_NEAR(solid_angle, 4 * 3.14159265, 1e-3) << "the dome is closed";
}

TEST(Backdrop, ColourReplacesTheEnvironmentAndNothingNeedsNone) {
  const Folder folder;
  const auto colour = test::load(folder, Model::triangle(), "environment = [1, 1, 1]\nbackground = [0.6, 0.5, 0.4]\n");
  EXPECT_FALSE(colour->background_is_environment);
  EXPECT_EQ(colour->background_color, glm::vec3(0.6f, 0.5f, 0.4f));
  const auto none = test::load(folder, Model::triangle());
  EXPECT_EQ(none->background_object, -1);
  EXPECT_EQ(none->objects.size(), 1u);
}

TEST(Shapes, ClosedSurfacesFaceOutwards) {
  for (const Geometry& g : {make_sphere(2, 24, 12), make_box({1, 2, 3})}) {
    double volume = 0;
    for (size_t t = 0; t < g.indices.size(); t += 3) {
      const glm::vec3 a = g.positions[g.indices[t]], b = g.positions[g.indices[t + 1]], c = g.positions[g.indices[t + 2]];
      volume += glm::dot(a, glm::cross(b, c)) / 6;
      EXPECT_GT(glm::dot(glm::cross(b - a, c - a), g.normals[g.indices[t]]), 0);
    }
    EXPECT_NEAR(volume, g.positions.size() == 24 ? 6 : 4.0 / 3 * 3.14159 * 8, 1.6);
  }
}

TEST(NewScene, WithoutAModelIsAWorkingScene) {
  const Folder folder;
  const fs::path directory = folder.path() / "first";
  const std::vector<fs::path> files = new_scene(directory, std::nullopt);
  EXPECT_EQ(files.size(), 3u);
  const auto scene = load_scene(directory);
  EXPECT_TRUE(scene->warnings.empty());
  ASSERT_EQ(scene->axes.size(), 2u);
  EXPECT_EQ(scene->axes[0].shape.samples, 32);
  EXPECT_EQ(scene->axes[1].shape.samples, 4);
  EXPECT_EQ(scene->name, "first");
  EXPECT_EQ(scene->objects.size(), 5u) << "plinth, ball, cube, lamp, background";
  EXPECT_FALSE(scene->background_is_environment);
  expect_depth_holds(*scene);
  // The model is in the picture, the lamp is not, wherever the dials stand.
  for (const Position& position : grid_of(*scene)) {
    const Pose pose = pose_scene(*scene, position);
    const glm::mat4 clip = clip_from_camera(scene->camera, 640 / 480.0f) * glm::inverse(pose.world_from_camera);
    for (int o = 0; o < 4; ++o)
      for (const glm::vec3& p : scene->objects[static_cast<size_t>(o)].geometry.positions) {
        const glm::vec4 c = clip * world_from_object(*scene, pose, o) * glm::vec4(p, 1);
        const bool inside = c.w > 0 && std::max(std::abs(c.x), std::abs(c.y)) < c.w;
        ASSERT_EQ(inside, o != 3) << scene->objects[static_cast<size_t>(o)].name;
      }
  }
}

TEST(NewScene, BringsTheModelAndItsCompanions) {
  const Folder folder;
  Model m = Model::triangle();
  m.json["buffers"] = {{{"byteLength", m.binary.size()}, {"uri", "parts/data%201.bin"}}};
  m.json["nodes"][0]["translation"] = {10, 20, 30};
  folder.write("my \"model\".gltf", m.json.dump());
  folder.write("parts/data 1.bin", m.binary);
  new_scene(folder.path() / "shop", folder.path() / "my \"model\".gltf");
  EXPECT_TRUE(fs::exists(folder.path() / "shop/parts/data 1.bin"));
  const auto scene = load_scene(folder.path() / "shop");
  const Pose pose = pose_scene(*scene, {});
  const glm::vec3 eye(pose.world_from_camera[3]);
  EXPECT_LT(glm::distance(eye, glm::vec3(10.5f, 20.5f, 30)), 10) << "the orbit is around the model";
  expect_depth_holds(*scene);
}

TEST(NewScene, OverwritesNothing) {
  const Folder folder;
  folder.write("full/precious.txt", "x");
  EXPECT_NE(
      test::error_of([&] { new_scene(folder.path() / "full", std::nullopt); }).find("the folder is not empty: name a new folder"),
      std::string::npos);
  EXPECT_NE(test::error_of([&] { new_scene(folder.path() / "full/precious.txt", std::nullopt); }).find("this is a file"),
            std::string::npos);
  EXPECT_NE(test::error_of([&] {
              new_scene(folder.path() / "new", folder.path() / "none.glb");
            }).find("none.glb: there is no such file"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(folder.path() / "new")) << "a model that cannot be read leaves no folder behind";
}

TEST(NewScene, WritesEveryKeyThatIsRead) {
  const Folder folder;
  new_scene(folder.path() / "s", std::nullopt);
  std::ifstream stream(folder.path() / "s/scene.toml");
  const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  for (const char* key : {"scene",
                          "environment",
                          "environment_rotation",
                          "background",
                          "resolution",
                          "samples_per_pixel",
                          "noise",
                          "max_radiance",
                          "caustics",
                          "exposure",
                          "name",
                          "orbit",
                          "lamp",
                          "animation",
                          "variants",
                          "lights",
                          "kind",
                          "samples",
                          "max_speed",
                          "node",
                          "representation",
                          "resolution_scale",
                          "profile",
                          "storage",
                          "interpolate",
                          "between"})
    EXPECT_NE(text.find(std::string(key) + " = "), std::string::npos) << key;
}

TEST(TableScene, LoadsWithItsDials) {
  const fs::path folder = fs::path(VITRINE_SOURCE_DIR) / "tests/scenes/table";
  const auto scene = load_scene(folder);
  ASSERT_EQ(scene->axes.size(), 2u);
  EXPECT_EQ(scene->axes[0].name, "view");
  EXPECT_EQ(scene->axes[0].shape.samples, 64);
  EXPECT_EQ(scene->objects.size(), 8u) << "seven meshes and the background";
  std::set<std::string> names;
  for (const Object& o : scene->objects) names.insert(o.name);
  EXPECT_TRUE(names.count("vase") && names.count("cup") && names.count("lamp"));
  EXPECT_EQ(camera_axes(*scene), 1u);
  EXPECT_EQ(geometry_axes(*scene), 3u);
  expect_depth_holds(*scene);
  // 63 steps of 1.8 degrees around the table's axis, 2.2 m away (make_table.py).
  const glm::vec3 first(pose_scene(*scene, Position{0}).world_from_camera[3]),
      last(pose_scene(*scene, Position{1}).world_from_camera[3]);
  const auto angle = [](const glm::vec3& p) { return std::atan2(p.x, p.z) * 180 / 3.14159265f; };
  EXPECT_NEAR(angle(last) - angle(first), 113.4f, 1e-3);
  EXPECT_NEAR(std::hypot(first.x, first.z), 2.2f, 1e-4);
}

}  // namespace
}  // namespace vitrine
