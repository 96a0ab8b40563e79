// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What a model says arrives in the scene: geometry, materials, skins, lights, variants.
#include "host/scene/gltf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "host/scene/gltf_materials.h"
#include "tests/scene/scene_files.h"

namespace vitrine {
namespace {

using nlohmann::json;
using test::Folder;
using test::Model;

GltfModel read(const Model& m, const std::vector<std::string>& variants = {}) {
  const std::string glb = m.glb();
  const Bytes bytes(glb.begin(), glb.end());
  return read_gltf({"model.glb", {}, variants, {}, &bytes});
}

// The corners of all triangles, as positions: what is seen, whatever the indices are.
std::vector<glm::vec3> corners(const Object& object) {
  std::vector<glm::vec3> points;
  for (const uint32_t i : object.geometry.indices) points.push_back(object.geometry.positions[i]);
  return points;
}

using test::expect_near;

Model square(int mode, const std::vector<uint16_t>& indices) {
  Model m = Model::triangle();
  m.primitive()["attributes"]["POSITION"] = m.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, 3);
  m.primitive()["indices"] = m.add_indices(indices);
  m.primitive()["mode"] = mode;
  return m;
}

TEST(Gltf, StripsAndFansShowTheSameSquareAsTriangles) {
  const std::vector<glm::vec3> list = corners(read(square(4, {0, 1, 2, 1, 3, 2})).objects[0]);
  EXPECT_EQ(corners(read(square(5, {0, 1, 2, 3})).objects[0]), list);
  const std::vector<glm::vec3> fan = corners(read(square(6, {0, 1, 3, 2})).objects[0]);
  ASSERT_EQ(fan.size(), 6u);
  for (size_t t = 0; t < 6; t += 3)
    EXPECT_GT(glm::cross(fan[t + 1] - fan[t], fan[t + 2] - fan[t]).z, 0) << "a fan's triangle is turned over";
}

// The volume inside a closed surface; positive where counter-clockwise is outside.
double volume(const Object& object) {
  const std::vector<glm::vec3> c = corners(object);
  double sum = 0;
  for (size_t t = 0; t + 2 < c.size(); t += 3) sum += glm::dot(glm::dvec3(c[t]), glm::cross(glm::dvec3(c[t + 1]), glm::dvec3(c[t + 2]))) / 6;
  return sum;
}

TEST(Gltf, LinesAreShownAsThinRodsFromEndToEnd) {
  const double radius = std::sqrt(2.0) / 250;  // the square's diagonal
  const auto rods = [&](double length) { return 2 * radius * radius * length; };
  EXPECT_NEAR(volume(read(square(1, {0, 1, 2, 3})).objects[0]), rods(2), 1e-3 * rods(2));
  EXPECT_NEAR(volume(read(square(3, {0, 1, 3, 2})).objects[0]), rods(3), 1e-3 * rods(3));
  EXPECT_NEAR(volume(read(square(2, {0, 1, 3, 2})).objects[0]), rods(4), 1e-3 * rods(4));
  EXPECT_EQ(corners(read(square(1, {0, 1, 2, 2})).objects[0]).size(), 36u) << "a line without length makes nothing";
}

TEST(Gltf, PointsAreShownAsSmallOctahedra) {
  const double radius = std::sqrt(2.0) / 100;
  EXPECT_NEAR(volume(read(square(0, {0, 1, 2, 3})).objects[0]), 4 * 4.0 / 3 * radius * radius * radius, 1e-8);
  EXPECT_GT(volume(read(square(0, {2})).objects[0]), 0) << "a lone point has no size to go by, and is seen";
}

TEST(Gltf, MeshWithNothingToShowIsSkippedAndTheRestIsShown) {
  Model m = Model::triangle();
  m.json["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"mode", 4}, {"indices", m.add_indices({0, 0, 1})}}}}});
  m.json["nodes"].push_back({{"mesh", 1}});
  m.json["scenes"][0]["nodes"].push_back(1);
  const GltfModel model = read(m);
  EXPECT_EQ(model.objects.size(), 1u);
  EXPECT_NE(model.warnings.back().find("meshes[1] has nothing to show"), std::string::npos);
}

TEST(Gltf, DegenerateTrianglesAreDroppedAndUnusedVerticesToo) {
  const Object object = read(square(4, {0, 1, 1, 0, 0, 0, 0, 1, 3})).objects[0];
  EXPECT_EQ(object.geometry.indices.size(), 3u);
  EXPECT_EQ(object.geometry.triangle_materials.size(), 1u);
}

TEST(Gltf, MissingNormalsAreFlatAndUnshared) {
  Model m = square(4, {0, 1, 2, 1, 3, 2});
  m.primitive()["attributes"]["POSITION"] = m.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1}, 3);  // folded
  const Geometry g = read(m).objects[0].geometry;
  ASSERT_EQ(g.positions.size(), 6u);
  expect_near(g.normals[0], {0, 0, 1});
  expect_near(g.normals[3], glm::normalize(glm::vec3(-1, -1, 1)));
}

TEST(Gltf, ZeroNormalsAreReplacedByTheSurfaces) {
  Model m = Model::triangle();
  m.primitive()["attributes"]["NORMAL"] = m.add_floats({0, 0, 5, 0, 0, 0, 0, 0, 1}, 3);
  const Geometry g = read(m).objects[0].geometry;
  for (const glm::vec3& n : g.normals) expect_near(n, {0, 0, 1});
}

TEST(Gltf, InterleavedAndNormalizedIntegersReadAsTheyWereMeant) {
  Model m = Model::triangle();
  // Per vertex: 3 floats, 2 normalized unsigned shorts, 4 normalized unsigned bytes (colour).
  std::string data;
  const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  for (int v = 0; v < 3; ++v) {
    data += test::bytes_of(std::vector<float>{positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]});
    data += test::bytes_of(std::vector<uint16_t>{static_cast<uint16_t>(v == 1 ? 65535 : 0), 32768});
    data += std::string{'\xff', '\x00', '\x33', '\x80'};
  }
  const int view = m.add_view(data);
  m.json["bufferViews"][static_cast<size_t>(view)]["byteStride"] = 20;
  auto& attributes = m.primitive()["attributes"];
  attributes["POSITION"] = m.add_accessor(view, 5126, 3, "VEC3");
  attributes["TEXCOORD_0"] = m.add_accessor(view, 5123, 3, "VEC2");
  m.json["accessors"].back()["byteOffset"] = 12;
  m.json["accessors"].back()["normalized"] = true;
  attributes["COLOR_0"] = m.add_accessor(view, 5121, 3, "VEC4");
  m.json["accessors"].back()["byteOffset"] = 16;
  m.json["accessors"].back()["normalized"] = true;
  const Geometry g = read(m).objects[0].geometry;
  EXPECT_EQ(g.texcoords[0][1], glm::vec2(1, 32768 / 65535.0f));
  EXPECT_EQ(g.colors[2], glm::vec4(1, 0, 0.2f, 128 / 255.0f));
  EXPECT_EQ(g.positions[2], glm::vec3(0, 1, 0));
}

TEST(Gltf, QuantizedPositionsAreReadWithoutFloats) {
  Model m = Model::triangle();
  m.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const int view = m.add_view(test::bytes_of(std::vector<int16_t>{0, 0, 0, 0, 32767, 0, 0, 0, 0, -32768, 0, 0}));
  m.json["bufferViews"][static_cast<size_t>(view)]["byteStride"] = 8;
  m.primitive()["attributes"]["POSITION"] = m.add_accessor(view, 5122, 3, "VEC3");
  m.json["accessors"].back()["normalized"] = true;
  const Geometry g = read(m).objects[0].geometry;
  EXPECT_EQ(g.positions[1], glm::vec3(1, 0, 0));
  EXPECT_EQ(g.positions[2], glm::vec3(0, -1, 0)) << "-32768 is clamped to -1";
}

TEST(Gltf, SparseAccessorsReplaceSingleVertices) {
  Model m = Model::triangle();
  const int at = m.add_view(std::string("\x02", 1)), to = m.add_view(test::bytes_of(std::vector<float>{0, 7, 0}));
  m.json["accessors"][0]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", at}, {"componentType", 5121}}}, {"values", {{"bufferView", to}}}};
  EXPECT_EQ(read(m).objects[0].geometry.positions[2], glm::vec3(0, 7, 0));
}

TEST(Gltf, MorphTargetsStandAtTheirRestWeights) {
  Model m = Model::triangle();
  m.primitive()["targets"] = {{{"POSITION", m.add_floats({0, 0, 4, 0, 0, 4, 0, 0, 4}, 3)}}};
  m.json["meshes"][0]["weights"] = {0.25};
  EXPECT_EQ(read(m).objects[0].geometry.positions[0], glm::vec3(0, 0, 1));
  m.json["nodes"][0]["weights"] = {0.5};
  EXPECT_EQ(read(m).objects[0].geometry.positions[0], glm::vec3(0, 0, 2)) << "the node's weights count before the mesh's";
}

TEST(Gltf, SkinsFollowTheirJointsAndIgnoreTheirNode) {
  Model m = Model::triangle();
  m.json["nodes"] = {{{"name", "body"}, {"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}},
                     {{"name", "hip"}, {"translation", {0, 2, 0}}},
                     {{"name", "hand"}, {"translation", {0, 0, 4}}}};
  m.json["nodes"][1]["children"] = {2};
  m.json["scenes"][0]["nodes"] = {0, 1};
  m.json["skins"] = {{{"joints", {1, 2}}}};
  m.primitive()["attributes"]["JOINTS_0"] =
      m.add_accessor(m.add_view(std::string("\0\1\0\0\0\1\0\0\0\1\0\0", 12)), 5121, 3, "VEC4");
  m.primitive()["attributes"]["WEIGHTS_0"] = m.add_floats({1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 0, 2, 0, 0}, 4);
  const GltfModel model = read(m);
  const Object& object = model.objects[0];
  EXPECT_EQ(object.geometry.positions[0], glm::vec3(0, 2, 0));
  EXPECT_EQ(object.geometry.positions[1], glm::vec3(1, 2, 2));
  EXPECT_EQ(object.geometry.positions[2], glm::vec3(0, 3, 4)) << "weights are scaled to a sum of 1";
  const RigNode& node = model.nodes[static_cast<size_t>(object.node)];
  EXPECT_EQ(node.parent, -1);
  EXPECT_EQ(node.translation, glm::vec3(0));
}

TEST(Gltf, MaterialsArriveWithTheirExtensions) {
  Model m = Model::triangle();
  m.json["materials"][0] = json::parse(R"({"name": "all", "alphaMode": "MASK", "alphaCutoff": 0.3, "doubleSided": true,
      "emissiveFactor": [0.5, 0.25, 0], "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.6, "roughnessFactor": 0.7},
      "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}, "KHR_materials_ior": {"ior": 1.33},
        "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [2, 1, 0.5]}, "KHR_materials_transmission": {"transmissionFactor": 0.9},
        "KHR_materials_volume": {"thicknessFactor": 0.01, "attenuationColor": [1, 0.5, 0.25], "attenuationDistance": 0.2},
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.8, "clearcoatRoughnessFactor": 0.05}, "KHR_materials_unlit": {}}})");
  const Material a = read(m).materials[0];
  EXPECT_EQ(a.base_color, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
  EXPECT_FLOAT_EQ(a.metallic, 0.6f);
  EXPECT_FLOAT_EQ(a.roughness, 0.7f);
  EXPECT_EQ(a.emissive, glm::vec3(4, 2, 0));
  EXPECT_EQ(a.alpha_mode, AlphaMode::kMask);
  EXPECT_FLOAT_EQ(a.alpha_cutoff, 0.3f);
  EXPECT_TRUE(a.double_sided && a.unlit);
  EXPECT_FLOAT_EQ(a.ior, 1.33f);
  EXPECT_FLOAT_EQ(a.specular, 0.5f);
  EXPECT_EQ(a.specular_color, glm::vec3(2, 1, 0.5f));
  EXPECT_FLOAT_EQ(a.transmission, 0.9f);
  EXPECT_FLOAT_EQ(a.thickness, 0.01f);
  EXPECT_EQ(a.attenuation_color, glm::vec3(1, 0.5f, 0.25f));
  EXPECT_FLOAT_EQ(a.attenuation_distance, 0.2f);
  EXPECT_FLOAT_EQ(a.clearcoat, 0.8f);
  EXPECT_FLOAT_EQ(a.clearcoat_roughness, 0.05f);
}

TEST(Gltf, DefaultsAreThoseOfTheStandard) {
  Model m = Model::triangle();
  m.primitive().erase("material");
  const Material a = read(m).materials[0];
  EXPECT_EQ(a.base_color, glm::vec4(1));
  EXPECT_EQ(a.metallic, 1);
  EXPECT_EQ(a.roughness, 1);
  EXPECT_EQ(a.ior, 1.5f);
  EXPECT_EQ(a.attenuation_distance, 0) << "0 stands for infinite";
}

TEST(Gltf, UnknownOptionalExtensionIsAWarning) {
  Model m = Model::triangle();
  m.json["extensionsUsed"] = {"KHR_materials_sheen", "KHR_materials_ior"};
  const GltfModel model = read(m);
  ASSERT_EQ(model.warnings.size(), 1u);
  EXPECT_NE(model.warnings[0].find("KHR_materials_sheen"), std::string::npos);
}

// KHR_texture_transform: "rotate counter-clockwise around the origin", v pointing down.
TEST(Gltf, TextureTransformScalesThenRotatesThenShifts) {
  const glm::mat3 turn = texture_transform({0, 0}, std::numbers::pi_v<float> / 2, {1, 1});
  expect_near(turn * glm::vec3(1, 0, 1), {0, -1, 1});
  expect_near(turn * glm::vec3(0, 1, 1), {1, 0, 1});
  const glm::mat3 all = texture_transform({10, 20}, std::numbers::pi_v<float> / 2, {2, 3});
  expect_near(all * glm::vec3(1, 1, 1), {13, 18, 1});
}

TEST(Gltf, TextureWithoutCoordinatesIsNeverReadOutOfBounds) {
  Model m = Model::triangle();
  const std::string png = {
      "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\x08\2\0\0\0\x90wS\xde\0\0\0\x0cIDATx\xda\x63\xf8\xcf\xc0\0\0\3\1\1\0\xc9\xfe"
      "\x92\xef\0\0\0\0IEND\xae\x42\x60\x82",
      69};
  m.json["images"] = {{{"bufferView", m.add_view(png)}}};
  m.json["textures"] = {{{"source", 0}}};
  m.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}, {"texCoord", 1}};
  const GltfModel model = read(m);
  EXPECT_EQ(model.objects[0].geometry.texcoords[1].size(), model.objects[0].geometry.positions.size());
  EXPECT_NE(model.warnings.back().find("has a texture but no TEXCOORD_1"), std::string::npos);
  EXPECT_EQ(model.images[0].rgba, (std::vector<uint8_t>{255, 0, 0, 255}));
}

TEST(Gltf, LightsKeepTheirUnits) {
  Model m = Model::triangle();
  m.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"},
                                                            {"intensity", 40},
                                                            {"color", {1, 0.5, 0}},
                                                            {"range", 7},
                                                            {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}}};
  m.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  const Light light = read(m).lights.at(0);
  EXPECT_EQ(light.kind, LightKind::kSpot);
  EXPECT_EQ(light.intensity, glm::vec3(40, 20, 0));
  EXPECT_EQ(light.range, 7);
  EXPECT_FLOAT_EQ(light.inner_cone, 0.1f);
  EXPECT_FLOAT_EQ(light.outer_cone, 0.2f);
}

TEST(Gltf, VariantsReplaceMaterialsOfTheirPrimitivesOnly) {
  Model m = Model::triangle();
  m.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "red"}}, {{"name", "blue"}}};
  m.json["materials"].push_back({{"name", "ruby"}});
  m.json["meshes"][0]["primitives"].push_back(m.primitive());
  m.primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {0}}}};
  const GltfModel model = read(m, {"blue", "red"});
  const Object& object = model.objects[0];
  ASSERT_EQ(object.variant_materials.size(), 2u);
  EXPECT_EQ(object.variant_materials[0], object.geometry.triangle_materials) << "blue changes nothing";
  EXPECT_EQ(model.materials[static_cast<size_t>(object.variant_materials[1][0])].name, "ruby");
  EXPECT_EQ(object.variant_materials[1][1], object.geometry.triangle_materials[1]);
}

TEST(Gltf, CompanionFilesAreFoundByEncodedNames) {
  const Folder folder;
  Model m = Model::triangle();
  m.json["buffers"] = {{{"byteLength", m.binary.size()}, {"uri", "data%20files/a%2Bb.bin"}}};
  folder.write("models/data files/a+b.bin", m.binary);
  folder.write("models/model.gltf", m.json.dump());
  folder.write("scene.toml", "scene = \"models/model.gltf\"\n");
  EXPECT_EQ(load_scene(folder.path())->objects.size(), 1u);
  m.json["buffers"][0]["uri"] = "../shared.bin";  // above the model, but within the scene
  folder.write("shared.bin", m.binary);
  folder.write("models/model.gltf", m.json.dump());
  EXPECT_EQ(load_scene(folder.path())->objects.size(), 1u);
}

TEST(Gltf, ObjectNamesAreUniqueAndFitOnOneLine) {
  Model m = Model::triangle();
  m.json["nodes"] = {{{"name", "a"}, {"mesh", 0}},
                     {{"name", "a"}, {"mesh", 0}},
                     {{"name", "a-2"}, {"mesh", 0}},
                     {{"name", "b\nc"}, {"mesh", 0}},
                     {{"mesh", 0}}};
  m.json["scenes"][0]["nodes"] = {0, 1, 2, 3, 4};
  const Folder folder;
  const auto scene = test::load(folder, m, "environment = [1, 1, 1]\n");
  std::vector<std::string> names;
  for (const Object& o : scene->objects) names.push_back(o.name);
  EXPECT_EQ(names, (std::vector<std::string>{"a", "a-2", "a-2-2", "b?c", "object-4", "background"}));
}

}  // namespace
}  // namespace vitrine
