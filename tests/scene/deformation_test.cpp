// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Meshes that axes deform: morph targets and skins at the pose of the dials.
#include "host/scene/deformation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <limits>

#include "host/scene/framing.h"
#include "host/scene/gltf.h"
#include "tests/scene/scene_files.h"

namespace vitrine {
namespace {

using nlohmann::json;
using test::expect_near;
using test::Folder;
using test::Model;

// One channel of one animation.
struct Channel {
  int node;
  const char* path;
  std::vector<float> times, values;
  size_t components;
  const char* interpolation = "LINEAR";
};

void add_animation(Model& m, const std::string& name, const std::vector<Channel>& channels) {
  json animation = {{"name", name}, {"samplers", json::array()}, {"channels", json::array()}};
  for (const Channel& c : channels) {
    const int input = m.add_floats(c.times, 1), output = m.add_floats(c.values, c.components);
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", c.node}, {"path", c.path}}}});
    animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", c.interpolation}});
  }
  m.json["animations"].push_back(animation);
}

// A picture of one texel for the material's texture of this name.
void add_texture(Model& m, const std::string& name) {
  const std::string png = {
      "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\x08\2\0\0\0\x90wS\xde\0\0\0\x0cIDATx\xda\x63\xf8\xcf\xc0\0\0\3\1\1\0\xc9\xfe"
      "\x92\xef\0\0\0\0IEND\xae\x42\x60\x82",
      69};
  m.json["images"] = {{{"bufferView", m.add_view(png)}}};
  m.json["textures"] = {{{"source", 0}}};
  json& material = m.json["materials"][0];
  (name == "normalTexture" ? material : material["pbrMetallicRoughness"])[name]["index"] = 0;
}

std::string axis(const std::string& animation) {
  return "[[axis]]\nname = \"" + animation + "\"\nanimation = \"" + animation + "\"\nsamples = 5\n";
}

DeformedMesh mesh_at(const Scene& scene, const Position& position) {
  return deformed_mesh(scene, pose_scene(scene, position), 0);
}

// The triangle, whose only morph target lifts it by 4 and leans its normals.
Model lifted_triangle() {
  Model m = Model::triangle();
  m.primitive()["attributes"]["NORMAL"] = m.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  m.primitive()["targets"] = {
      {{"POSITION", m.add_floats({0, 0, 4, 0, 0, 4, 0, 0, 4}, 3)}, {"NORMAL", m.add_floats({1, 0, 0, 1, 0, 0, 1, 0, 0}, 3)}}};
  return m;
}

float lift_at(const Scene& scene, float position) { return mesh_at(scene, {position}).geometry.positions[0].z; }

TEST(MorphWeights, HalfAWeightMovesAVertexByHalfItsDisplacementAndTurnsItsNormal) {
  Model m = lifted_triangle();
  add_animation(m, "lift", {{0, "weights", {0, 2}, {0, 1}, 1}});
  const Folder folder;
  const auto scene = test::load(folder, m, axis("lift"));
  const Geometry g = mesh_at(*scene, {0.5f}).geometry;
  expect_near(g.positions[1], {1, 0, 2});
  expect_near(g.normals[1], glm::normalize(glm::vec3(0.5f, 0, 1)));
  EXPECT_EQ(lift_at(*scene, 0), 0);
  EXPECT_EQ(lift_at(*scene, 1), 4);
  EXPECT_EQ(scene->objects[0].geometry.positions[0].z, 0) << "without a pose the mesh is at rest";
}

TEST(MorphWeights, StepsJumpAndTheEndsAreHeld) {
  Model m = lifted_triangle();
  add_animation(m, "lift", {{0, "weights", {1, 2, 4}, {0.25f, 0.5f, 1}, 1, "STEP"}});
  const Folder folder;
  const auto scene = test::load(folder, m, axis("lift"));
  const float expected[][2] = {{0, 1}, {0.2f, 1}, {0.26f, 1}, {0.49f, 1}, {0.51f, 2}, {0.99f, 2}, {1, 4}};
  for (const auto& [position, lift] : expected) EXPECT_EQ(lift_at(*scene, position), lift) << position;
}

// glTF 2.0, appendix C.5, with end slopes 3 and -1 per second over 2 seconds.
TEST(MorphWeights, CubicTangentsArePerSecondWhateverTheDuration) {
  Model m = lifted_triangle();
  add_animation(m, "lift", {{0, "weights", {0, 2}, {0, 0, 3, -1, 1, 0}, 1, "CUBICSPLINE"}});
  const Folder folder;
  const auto scene = test::load(folder, m, axis("lift"));
  for (const float t : {0.0f, 0.25f, 0.5f, 0.9f, 1.0f}) {
    const float t2 = t * t, t3 = t2 * t;
    const float weight = (t3 - 2 * t2 + t) * 2 * 3 + (-2 * t3 + 3 * t2) * 1 + (t3 - t2) * 2 * -1;
    EXPECT_NEAR(lift_at(*scene, t), 4 * weight, 1e-5f) << t;
  }
}

TEST(MorphWeights, EveryTargetHasItsOwnCurve) {
  Model m = lifted_triangle();
  m.primitive()["targets"].push_back({{"POSITION", m.add_floats({10, 0, 0, 10, 0, 0, 10, 0, 0}, 3)}});
  m.json["nodes"][0]["weights"] = {1, 1};
  // Key by key, target by target; the second is cubic: in-tangents, values, out-tangents.
  add_animation(m, "lift", {{0, "weights", {0, 1}, {0, 1, 1, 0}, 1}});
  add_animation(m, "bend", {{0, "weights", {0, 1}, {0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0}, 1, "CUBICSPLINE"}});
  const Folder folder;
  const auto linear = test::load(folder, m, axis("lift"));
  expect_near(mesh_at(*linear, {0.25f}).geometry.positions[0], {7.5f, 0, 1});
  const auto cubic = test::load(folder, m, axis("bend"));
  const float eased = 3 * 0.0625f - 2 * 0.015625f;
  expect_near(mesh_at(*cubic, {0.25f}).geometry.positions[0], {10 * (1 - eased), 0, 4 * eased});
  expect_near(cubic->objects[0].geometry.positions[0], {10, 0, 4});  // at rest the node's own weights hold
}

TEST(MorphWeights, SparseTargetsMoveOnlyTheirVertices) {
  Model m = Model::triangle();
  const int at = m.add_view(std::string("\x02", 1)), to = m.add_view(test::bytes_of(std::vector<float>{0, 7, 0}));
  m.json["accessors"].push_back(
      {{"componentType", 5126},
       {"count", 3},
       {"type", "VEC3"},
       {"sparse", {{"count", 1}, {"indices", {{"bufferView", at}, {"componentType", 5121}}}, {"values", {{"bufferView", to}}}}}});
  m.primitive()["targets"] = {{{"POSITION", m.json["accessors"].size() - 1}}};
  add_animation(m, "lift", {{0, "weights", {0, 1}, {0, 1}, 1}});
  const Folder folder;
  const Geometry g = mesh_at(*test::load(folder, m, axis("lift")), {1}).geometry;
  EXPECT_EQ(g.positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 8, 0}}));
}

TEST(MorphWeights, FlatNormalsFollowTheDeformedTriangle) {
  Model m = Model::triangle();
  m.primitive()["targets"] = {{{"POSITION", m.add_floats({0, 0, 0, 0, 0, 1, 0, 0, 0}, 3)}}};
  add_animation(m, "lift", {{0, "weights", {0, 1}, {0, 1}, 1}});
  const Folder folder;
  const auto scene = test::load(folder, m, axis("lift"));
  expect_near(mesh_at(*scene, {0}).geometry.normals[0], {0, 0, 1});
  expect_near(mesh_at(*scene, {1}).geometry.normals[0], glm::normalize(glm::vec3(-1, 0, 1)));
}

TEST(MorphWeights, TangentsAreDisplacedToo) {
  Model m = Model::triangle();
  m.primitive()["attributes"]["NORMAL"] = m.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  m.primitive()["attributes"]["TANGENT"] = m.add_floats({1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1}, 4);
  m.primitive()["targets"] = {{{"TANGENT", m.add_floats({0, 1, 0, 0, 1, 0, 0, 1, 0}, 3)}}};
  add_animation(m, "turn", {{0, "weights", {0, 1}, {0, 1}, 1}});
  const Folder folder;
  const glm::vec4 tangent = mesh_at(*test::load(folder, m, axis("turn")), {1}).geometry.tangents[2];
  expect_near(tangent, glm::normalize(glm::vec3(1, 1, 0)));
  EXPECT_EQ(tangent.w, -1);
}

TEST(MorphWeights, WhatHasNoAreaAtRestIsSeenWhereItOpens) {
  Model m = Model::triangle();
  m.primitive()["attributes"]["POSITION"] = m.add_floats({0, 0, 0, 1, 0, 0, 2, 0, 0}, 3);
  m.primitive()["targets"] = {{{"POSITION", m.add_floats({0, 0, 0, 0, 0, 0, 0, 1, 0}, 3)}}};
  add_animation(m, "open", {{0, "weights", {0, 1}, {0, 1}, 1}});
  const Folder folder;
  const auto scene = test::load(folder, m, axis("open"));
  EXPECT_EQ(mesh_at(*scene, {0}).geometry.indices.size(), 0u);
  EXPECT_EQ(mesh_at(*scene, {1}).geometry.indices.size(), 3u);
  EXPECT_TRUE(std::isfinite(scene->camera.near_distance) && std::isfinite(scene->camera.far_distance));
}

TEST(MorphWeights, LinesThatArePointsAtRestKeepTheirTextureCoordinates) {
  Model m = Model::triangle();
  m.primitive()["mode"] = 1;
  m.primitive()["indices"] = m.add_indices({0, 1});
  m.primitive()["attributes"]["POSITION"] = m.add_floats({0, 0, 0, 0, 0, 0, 0, 0, 0}, 3);
  m.primitive()["attributes"]["TEXCOORD_0"] = m.add_floats({0.25f, 0.5f, 0.75f, 0.5f, 0, 0}, 2);
  m.primitive()["targets"] = {{{"POSITION", m.add_floats({0, 0, 0, 1, 0, 0, 0, 0, 0}, 3)}}};
  add_texture(m, "baseColorTexture");
  add_animation(m, "stretch", {{0, "weights", {0, 1}, {0, 1}, 1}});
  const Folder folder;
  const auto scene = test::load(folder, m, axis("stretch"));
  EXPECT_TRUE(mesh_at(*scene, {0}).geometry.indices.empty());
  const Geometry g = mesh_at(*scene, {1}).geometry;
  ASSERT_EQ(g.texcoords[0].size(), g.positions.size());
  EXPECT_EQ(g.texcoords[0][0], glm::vec2(0.25f, 0.5f));
}

constexpr float kHalf = 0.70710678f;  // sine and cosine of 45 degrees: a rotation by 90

// A bar of two quads from y = 0 to 2, one unit wide, facing +Z; joints at its foot (node 1) and half way (node 2). The foot's
// vertices hang on the first, the tip's on the second, those between half on each.
Model bar() {
  Model m = Model::triangle();
  auto& attributes = m.primitive()["attributes"];
  attributes["POSITION"] = m.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0}, 3);
  attributes["NORMAL"] = m.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1}, 3);  // one leans, to see it turn
  attributes["TANGENT"] = m.add_floats({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, 1, 1, 0, 0, 1}, 4);
  m.primitive()["indices"] = m.add_indices({0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4});
  attributes["JOINTS_0"] =
      m.add_accessor(m.add_view(std::string("\0\1\0\0\0\1\0\0\0\1\0\0\0\1\0\0\0\1\0\0\0\1\0\0", 24)), 5121, 6, "VEC4");
  attributes["WEIGHTS_0"] = m.add_floats({1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 0.5f, 0.5f, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, 4);
  m.json["nodes"] = {{{"name", "bar"}, {"mesh", 0}, {"skin", 0}, {"translation", {50, 0, 0}}},
                     {{"name", "foot"}, {"children", {2}}},
                     {{"name", "knee"}, {"translation", {0, 1, 0}}}};
  m.json["scenes"][0]["nodes"] = {0, 1};
  const int inverse = m.add_floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,  //
                                    1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1},
                                   16);
  m.json["accessors"].back()["type"] = "MAT4";
  m.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", inverse}}};
  return m;
}

const Channel kKneeTurns{2, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, kHalf, kHalf}, 4};  // by 90 degrees about +Z
const Channel kFootMoves{1, "translation", {0, 1}, {0, 0, 0, 0, 0, 8}, 3};

TEST(Skin, ABarBendsAtItsJointAndItsNormalsAndTangentsTurnAlong) {
  Model m = bar();
  add_animation(m, "bend", {kKneeTurns});
  const Folder folder;
  const auto scene = test::load(folder, m, axis("bend"));
  for (const float position : {0.0f, 0.3f, 1.0f}) {
    const float angle = position * 1.57079633f, c = std::cos(angle), s = std::sin(angle);
    // About (0, 1): the point p goes to (0, 1) + R (p - (0, 1)).
    const auto bent = [&](float x, float y) { return glm::vec3(c * x - s * (y - 1), 1 + s * x + c * (y - 1), 0); };
    const Geometry g = mesh_at(*scene, {position}).geometry;
    expect_near(g.positions[0], {0, 0, 0});
    expect_near(g.positions[1], {1, 0, 0});
    expect_near(g.positions[3], 0.5f * (glm::vec3(1, 1, 0) + bent(1, 1)));
    expect_near(g.positions[4], bent(0, 2));
    expect_near(g.positions[5], bent(1, 2));
    expect_near(g.normals[4], {c, s, 0});
    expect_near(g.normals[5], {0, 0, 1});
    expect_near(g.tangents[5], {c, s, 0});
  }
}

// A character exported below a node of scale -1 is single-sided as a rule: turned inside out, it could not be seen at all.
TEST(Skin, AMirroredFigureShowsItsFrontsAndItsNormalMapsTheRightWayRound) {
  for (const bool animated : {false, true})
    for (const float mirror : {1.0f, -1.0f}) {
      Model m = bar();
      m.primitive()["attributes"]["NORMAL"] = m.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
      m.json["nodes"].push_back({{"name", "mirror"}, {"scale", {mirror, 1, 1}}, {"children", {0, 1}}});
      m.json["scenes"][0]["nodes"] = {3};
      if (animated) add_animation(m, "bend", {kKneeTurns});
      const Folder folder;
      const auto scene = test::load(folder, m, animated ? axis("bend") : "");
      SCOPED_TRACE(testing::Message() << (animated ? "animated" : "at rest") << ", scale " << mirror);
      const Geometry g = animated ? mesh_at(*scene, {0.0f}).geometry : scene->objects[0].geometry;
      expect_near(g.positions[1], {mirror, 0, 0});
      for (size_t t = 0; t < g.indices.size(); t += 3) {
        const auto corner = [&](size_t k) { return g.positions[g.indices[t + k]]; };
        EXPECT_GT(glm::cross(corner(1) - corner(0), corner(2) - corner(0)).z, 0) << "triangle " << t / 3 << " is turned over";
      }
      expect_near(g.normals[1], {0, 0, 1});
      expect_near(g.tangents[1], {mirror, 0, 0});
      expect_near(g.tangents[1].w * glm::cross(g.normals[1], glm::vec3(g.tangents[1])), {0, 1, 0});
    }
}

TEST(Skin, SeveralAxesAndMorphTargetsWorkTogetherMorphFirst) {
  Model m = bar();
  m.primitive()["targets"] = {{{"POSITION", m.add_floats({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0}, 3)}}};
  add_animation(m, "bend", {kKneeTurns});
  add_animation(m, "move", {kFootMoves});
  add_animation(m, "grow", {{0, "weights", {0, 1}, {0, 2}, 1}});
  const Folder folder;
  const auto scene = test::load(folder, m, axis("move") + axis("grow") + axis("bend"));
  const Geometry g = mesh_at(*scene, {0.5f, 0.25f, 1}).geometry;
  expect_near(g.positions[0], {0, 0, 4});
  expect_near(g.positions[4], {-1.5f, 1, 4});  // grown to y = 2.5 before the knee turns it
  EXPECT_EQ(deforming_axes(*scene, 0), 7u);
  EXPECT_EQ(geometry_axes(*scene), 7u);
}

TEST(Skin, AFurtherSetOfJointsCounts) {
  Model m = bar();
  auto& attributes = m.primitive()["attributes"];
  attributes["JOINTS_1"] = m.add_accessor(m.add_view(std::string(24, '\1')), 5121, 6, "VEC4");
  attributes["WEIGHTS_1"] = m.add_floats({0.5f, 0.5f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 4);
  add_animation(m, "bend", {kKneeTurns});
  const Folder folder;
  const Geometry g = mesh_at(*test::load(folder, m, axis("bend")), {1}).geometry;
  expect_near(g.positions[0], {0.5f, 0.5f, 0});  // between (0, 0) and where the knee takes it, (1, 1)
}

TEST(Skin, ANodeAboveTheJointsCarriesTheMeshAlong) {
  Model m = bar();
  m.json["nodes"].push_back({{"name", "hips"}, {"children", {1}}});
  m.json["scenes"][0]["nodes"] = {0, 3};
  add_animation(m, "walk", {{3, "translation", {0, 1}, {0, 0, 0, 2, 0, 0}, 3}});
  const Folder folder;
  expect_near(mesh_at(*test::load(folder, m, axis("walk")), {0.5f}).geometry.positions[4], {1, 2, 0});
}

TEST(Skin, AJointOutsideTheSceneStandsStill) {
  Model m = bar();
  m.json["nodes"].push_back({{"name", "elsewhere"}, {"translation", {0, 0, 5}}});
  m.json["skins"][0]["joints"] = {3, 2};
  add_animation(m, "bend", {kKneeTurns});
  const Folder folder;
  const Geometry g = mesh_at(*test::load(folder, m, axis("bend")), {1}).geometry;
  expect_near(g.positions[0], {0, 0, 5});
  expect_near(g.positions[4], {-1, 1, 0});
}

TEST(Skin, AnAxisThatMovesSomethingElseLeavesTheMeshBaked) {
  Model m = bar();
  m.json["nodes"].push_back({{"name", "lamp"}});
  m.json["scenes"][0]["nodes"].push_back(3);
  add_animation(m, "bend", {kKneeTurns});
  add_animation(m, "lamp", {{3, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, 3}});
  const Folder folder;
  const auto rigid = test::load(folder, m, axis("lamp"));
  EXPECT_EQ(rigid->objects[0].deformation, nullptr);
  EXPECT_EQ(deforming_axes(*rigid, 0), 0u);
  const auto bent = test::load(folder, m, axis("bend"));
  EXPECT_EQ(rigid->objects[0].geometry.positions, bent->objects[0].geometry.positions) << "both are at rest";
}

void expect_same_mesh(const Geometry& a, const Geometry& b) {
  ASSERT_EQ(a.indices, b.indices);
  ASSERT_EQ(a.positions.size(), b.positions.size());
  ASSERT_EQ(a.tangents.size(), b.tangents.size());
  for (size_t i = 0; i < a.positions.size(); ++i) {
    expect_near(a.positions[i], b.positions[i]);
    expect_near(a.normals[i], b.normals[i]);
    if (!a.tangents.empty()) expect_near(a.tangents[i], b.tangents[i], 1e-4f);
  }
  EXPECT_EQ(a.texcoords, b.texcoords);
  EXPECT_EQ(a.triangle_materials, b.triangle_materials);
}

// The bar with a normal map whose tangents are not in the file, in whatever shape the bar is drawn.
Model textured_bar(int mode, const std::vector<uint16_t>& indices) {
  Model m = bar();
  add_texture(m, "normalTexture");
  m.primitive()["attributes"].erase("TANGENT");
  m.primitive()["attributes"]["TEXCOORD_0"] = m.add_floats({0, 1, 1, 1, 0, 0.5f, 1, 0.5f, 0, 0, 1, 0}, 2);
  m.primitive()["mode"] = mode;
  m.primitive()["indices"] = m.add_indices(indices);
  m.primitive()["targets"] = {{{"POSITION", m.add_floats({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0}, 3)}}};
  return m;
}

TEST(Skin, APoseIsTheMeshOfAFileWithThePoseInIt) {
  const std::pair<int, std::vector<uint16_t>> shapes[] = {{0, {0, 1, 2, 3, 4, 5}},
                                                          {1, {0, 1, 2, 3, 4, 5}},
                                                          {3, {0, 1, 3, 2, 4, 5}},
                                                          {4, {0, 1, 2, 1, 3, 2, 2, 3, 4, 3, 5, 4}},
                                                          {5, {0, 1, 2, 3, 4, 5}}};
  for (const auto& [mode, indices] : shapes) {
    for (const bool normals : {true, false}) {
      SCOPED_TRACE("mode " + std::to_string(mode) + (normals ? "" : ", without normals"));
      Model m = textured_bar(mode, indices);
      if (!normals) m.primitive()["attributes"].erase("NORMAL");
      Model baked = m;
      baked.json["nodes"][0]["weights"] = {0.5};
      baked.json["nodes"][1]["translation"] = {0, 0, 4};
      const float angle = 0.25f * 1.57079633f;
      baked.json["nodes"][2]["rotation"] = {0, 0, std::sin(angle), std::cos(angle)};
      add_animation(m, "all", {kKneeTurns, kFootMoves, {0, "weights", {0, 1}, {0, 1}, 1}});
      const Folder folder, other;
      const auto expected = test::load(other, baked);
      ASSERT_EQ(expected->objects[0].deformation, nullptr);
      expect_same_mesh(mesh_at(*test::load(folder, m, axis("all")), {0.5f}).geometry, expected->objects[0].geometry);
    }
  }
}

TEST(Skin, MaterialVariantsFollowTheTrianglesThatAreLeft) {
  Model m = bar();
  m.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "plain"}}, {{"name", "gold"}}};
  m.json["materials"].push_back({{"name", "gold paint"}});
  m.primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {1}}}};
  add_animation(m, "fold", {{2, "scale", {0, 1}, {1, 1, 1, 0, 0, 0}, 3}});
  const Folder folder;
  const auto scene = test::load(folder, m, axis("fold") + "[[axis]]\nname = \"finish\"\nvariants = [\"plain\", \"gold\"]\n");
  for (const float position : {0.0f, 0.5f, 1.0f}) {
    const DeformedMesh mesh = mesh_at(*scene, {position});
    EXPECT_EQ(mesh.geometry.triangle_materials.size(), mesh.geometry.indices.size() / 3);
    ASSERT_EQ(mesh.variant_materials.size(), 2u);
    for (const auto& row : mesh.variant_materials) EXPECT_EQ(row.size(), mesh.geometry.indices.size() / 3);
    EXPECT_EQ(scene->materials[static_cast<size_t>(mesh.variant_materials[1][0])].name, "gold paint");
  }
  EXPECT_LT(mesh_at(*scene, {1}).geometry.indices.size(), mesh_at(*scene, {0}).geometry.indices.size());
}

TEST(Deformation, TheViewHoldsTheMeshAtEveryPose) {
  Model m = bar();
  add_animation(m, "move", {{1, "translation", {0, 1}, {0, 0, 0, 0, 30, 0}, 3}});
  const Folder folder;
  const auto scene = test::load(folder, m, axis("move"));
  const Sphere bounds = bounds_of(*scene);
  for (const float position : {0.0f, 0.25f, 1.0f}) {
    const Pose pose = pose_scene(*scene, {position});
    for (const glm::vec3& p : deformed_mesh(*scene, pose, 0).geometry.positions) {
      EXPECT_LE(glm::distance(p, bounds.center), 1.001f * bounds.radius);
      const float distance = glm::distance(p, glm::vec3(pose.world_from_camera[3]));
      EXPECT_GT(distance, scene->camera.near_distance);
      EXPECT_LT(distance, scene->camera.far_distance);
    }
  }
}

std::string error_with(const std::function<void(Model&)>& bend, const std::string& axes) {
  Model m = bar();
  m.primitive()["targets"] = {{{"POSITION", m.primitive()["attributes"]["POSITION"]}}};
  bend(m);
  const Folder folder;
  const std::string error = test::error_of([&] { test::load(folder, m, axes); });
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  return error;
}

TEST(Deformation, FilesThatContradictThemselvesGetOneLineThatSaysHow) {
  struct Case {
    const char* error;
    std::function<void(Model&)> bend;
  };
  const Case cases[] = {
      {"moves morph weights of node 1, which has no morph targets",
       [](Model& m) {
         add_animation(m, "a", {{1, "weights", {0, 1}, {0, 1}, 1}});
       }},
      {"has 3 weights, but its 2 keys need 2",
       [](Model& m) {
         add_animation(m, "a", {{0, "weights", {0, 1}, {0, 1, 0}, 1}});
       }},
      {"has 2 weights, but its 2 keys need 6",
       [](Model& m) {
         add_animation(m, "a", {{0, "weights", {0, 1}, {0, 1}, 1, "CUBICSPLINE"}});
       }},
      {"has 3 components, needed are 1",
       [](Model& m) {
         add_animation(m, "a", {{0, "weights", {0, 1}, {0, 0, 0, 1, 1, 1}, 3}});
       }},
      {"is not a finite number",
       [](Model& m) {
         add_animation(m, "a", {{0, "weights", {0, 1}, {0, std::numeric_limits<float>::quiet_NaN()}, 1}});
       }},
      {"moves node 0 a second time on the same path",
       [](Model& m) {
         add_animation(m, "a", {{0, "weights", {0, 1}, {0, 1}, 1}, {0, "weights", {0, 1}, {0, 1}, 1}});
       }},
      {"meshes[0]: there are 1 targets, but 2 weights",
       [](Model& m) {
         m.json["nodes"][0]["weights"] = {0, 1};
         add_animation(m, "a", {{0, "weights", {0, 1}, {0, 1}, 1}});
       }},
      {"primitives[1].targets: there are 2 targets, but 1 weights",
       [](Model& m) {
         m.json["meshes"][0]["primitives"].push_back(m.primitive());
         m.json["meshes"][0]["primitives"][1]["targets"].push_back(m.primitive()["targets"][0]);
         add_animation(m, "a", {{0, "weights", {0, 1}, {0, 1}, 1}});
       }},
      {"targets[0].POSITION: has 3 elements, but there are 6 positions",
       [](Model& m) {
         m.primitive()["targets"][0]["POSITION"] = m.add_floats({0, 0, 0, 0, 0, 0, 0, 0, 0}, 3);
         add_animation(m, "a", {{0, "weights", {0, 1}, {0, 1}, 1}});
       }},
      {"inverseBindMatrices: has fewer matrices than the skin has joints (3)",
       [](Model& m) {
         m.json["skins"][0]["joints"].push_back(0);
         add_animation(m, "a", {kKneeTurns});
       }},
      {"hangs on joint 1, but its skin has 1",
       [](Model& m) {
         m.json["skins"][0]["joints"] = {2};
         add_animation(m, "a", {kKneeTurns});
       }},
      {"meshes[0].primitives[0]: a vertex lies farther than 1e12 metres away",
       [](Model& m) {
         add_animation(m, "a", {{0, "weights", {0, 1}, {0, 3e38f}, 1}});
       }},
      {"meshes[0].primitives[0]: a vertex lies farther than 1e12 metres away",
       [](Model& m) {
         add_animation(m, "a", {{1, "scale", {0, 1}, {1, 1, 1, 3e38f, 3e38f, 3e38f}, 3}});
       }},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.error);
    const std::string error = error_with(c.bend, axis("a"));
    EXPECT_NE(error.find(c.error), std::string::npos) << error;
  }
}

TEST(Deformation, TwoAxesOnTheSameWeightsAreAnError) {
  const std::string error = error_with(
      [](Model& m) {
        add_animation(m, "a", {{0, "weights", {0, 1}, {0, 1}, 1}});
        add_animation(m, "b", {{0, "weights", {0, 1}, {1, 0}, 1}});
      },
      axis("a") + axis("b"));
  EXPECT_NE(error.find("axis 2 (\"b\"): it drives the morph targets of \"bar\", which another axis drives already"),
            std::string::npos)
      << error;
}

// Every animation of every good model that deforms something, whatever it is.
TEST(Deformation, RealModelsMoveAndStayInOnePiece) {
  const std::filesystem::path assets = std::filesystem::path(VITRINE_EXTRA_ASSETS) / "assets/gltf";
  if (!std::filesystem::exists(assets)) GTEST_SKIP() << "no assets at " << assets << " (VITRINE_EXTRA_ASSETS)";
  int deformed = 0;
  for (const auto& entry : std::filesystem::directory_iterator(assets)) {
    const std::filesystem::path file = entry.path();
    if (file.extension() != ".glb") continue;
    GltfModel model;
    if (!test::error_of([&] { model = read_gltf({file, {}, {}, {}, nullptr}); }).empty()) continue;
    for (const std::string& name : model.animation_names) {
      SCOPED_TRACE(file.string() + ", " + name);
      const Folder folder;
      std::filesystem::copy_file(file, folder.path() / "model.glb");
      folder.write("scene.toml", "scene = \"model.glb\"\n" + std::string("[[axis]]\nname = \"a\"\nsamples = 5\nanimation = \"") +
                                     name + "\"\n");
      const auto scene = load_scene(folder.path());
      const float radius = bounds_of(*scene).radius;
      for (size_t o = 0; o < scene->objects.size(); ++o) {
        if (!scene->objects[o].deformation) continue;
        ++deformed;
        const Geometry& rest = scene->objects[o].geometry;
        const Geometry g = deformed_mesh(*scene, pose_scene(*scene, {0.37f}), static_cast<int>(o)).geometry;
        ASSERT_EQ(g.positions.size(), rest.positions.size());
        float farthest = 0;
        for (size_t i = 0; i < g.positions.size(); ++i) {
          farthest = std::max(farthest, glm::distance(g.positions[i], rest.positions[i]));
          ASSERT_NEAR(glm::length(g.normals[i]), 1, 1e-4);
        }
        EXPECT_GT(farthest, 1e-3f * radius) << "the pose differs from rest";
        EXPECT_LT(farthest, 4 * radius);
      }
    }
  }
  EXPECT_GE(deformed, 3) << "the three gaits of a fox";
}

}  // namespace
}  // namespace vitrine
