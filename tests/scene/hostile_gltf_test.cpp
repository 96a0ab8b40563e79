// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Models that were made to hurt: each ends in one line that says where and what.
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "host/scene/deformation.h"
#include "tests/scene/scene_files.h"

namespace vitrine {
namespace {

using nlohmann::json;
using test::Folder;
using test::Model;

struct HostileModel {
  const char* name;
  std::function<std::string()> bytes;  // of model.glb
  const char* error;                   // part of the message
};

HostileModel bent(const char* name, const std::function<void(Model&)>& bend, const char* error) {
  return {name,
          [bend] {
            Model m = Model::triangle();
            bend(m);
            return m.glb();
          },
          error};
}

std::string with_byte_patch(size_t at, uint32_t value) {
  std::string glb = Model::triangle().glb();
  glb.replace(at, 4, test::u32(value));
  return glb;
}

std::string deep_json() {
  return Model::triangle().glb_of("{\"asset\":{\"version\":\"2.0\"},\"extras\":" + std::string(100000, '[') +
                                  std::string(100000, ']') + "}");
}

void add_child_cycle(Model& m) {
  m.json["nodes"].push_back({{"children", {2}}});
  m.json["nodes"].push_back({{"children", {1}}});
}

void add_texture(Model& m, const json& image) {
  m.json["images"] = nlohmann::json::array({image});
  m.json["textures"] = {{{"source", 0}}};
  m.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 0;
}

std::string png_header(uint32_t width, uint32_t height) {
  const auto big = [](uint32_t v) { return std::string{char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; };
  return "\x89PNG\r\n\x1a\n" + big(13) + "IHDR" + big(width) + big(height) + std::string("\x08\x02\0\0\0", 5) + "crc!";
}

void add_animation(Model& m, const std::vector<float>& times, const std::vector<float>& values, const json& target) {
  const int input = m.add_floats(times, 1), output = m.add_floats(values, 3);
  m.json["animations"] = {{{"name", "a"},
                           {"samplers", {{{"input", input}, {"output", output}}}},
                           {"channels", {{{"sampler", 0}, {"target", target}}}}}};
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

const std::vector<HostileModel>& hostile_models() {
  static const std::vector<HostileModel> models = {
      {"empty", [] { return std::string(); }, "model.glb: the file is empty"},
      {"noise", [] { return std::string("\x01\x02\n\n garbage"); }, "its JSON is wrong at byte 1"},
      {"header_cut", [] { return Model::triangle().glb().substr(0, 11); }, "the GLB header is cut short"},
      {"version_3", [] { return with_byte_patch(4, 3); }, "is GLB version 3"},
      {"length_too_long", [] { return with_byte_patch(8, 0xFFFFFFFF); }, "the GLB header promises 4294967295 bytes"},
      {"length_too_short", [] { return with_byte_patch(8, 8); }, "the GLB has no JSON chunk"},
      {"chunk_too_long", [] { return with_byte_patch(12, 0xFFFFFFF0); }, "chunk 0 promises 4294967280 bytes"},
      {"chunk_not_json", [] { return with_byte_patch(16, 7); }, "the first GLB chunk is not JSON"},
      {"json_too_deep", deep_json, "its JSON is nested too deeply"},
      {"json_invalid_utf8", [] { return Model::triangle().glb_of("{\"asset\":\"\xff\"}"); }, "its JSON is wrong at byte"},
      {"json_array", [] { return Model::triangle().glb_of("[]"); }, "must be a JSON object"},
      bent(
          "no_asset", [](Model& m) { m.json.erase("asset"); }, "has no \"asset\""),
      bent(
          "version_1", [](Model& m) { m.json["asset"]["version"] = "1.0"; }, "asset.version: is \"1.0\""),
      bent(
          "version_huge", [](Model& m) { m.json["asset"]["version"] = std::string(99999, '2'); }, "asset.version: is \"2222"),
      bent(
          "newlines_in_names", [](Model& m) { m.json["extensionsRequired"] = {"A\nB\r\tC"}; },
          "requires \"A?B??C\", which Vitrine does not read"),
      bent(
          "required_draco", [](Model& m) { m.json["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
          "the model requires \"KHR_draco_mesh_compression\""),
      bent("node_cycle", add_child_cycle, "nodes: some nodes are children of their own children"),
      bent(
          "node_own_child", [](Model& m) { m.json["nodes"][0]["children"] = {0}; },
          "nodes: some nodes are children of their own children"),
      bent(
          "two_parents",
          [](Model& m) {
            m.json["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
          },
          "nodes[1].children[0]: node 2 is already a child of node 0"),
      bent(
          "child_out_of_range", [](Model& m) { m.json["nodes"][0]["children"] = {5}; },
          "nodes[0].children[0]: is 5, but there are 1 nodes"),
      bent(
          "child_negative", [](Model& m) { m.json["nodes"][0]["children"] = {-1}; }, "nodes[0].children[0]: is -1"),
      bent(
          "mesh_out_of_range", [](Model& m) { m.json["nodes"][0]["mesh"] = 1; }, "nodes[0].mesh: is 1, but there are 1 meshes"),
      bent(
          "mesh_is_text", [](Model& m) { m.json["nodes"][0]["mesh"] = "0"; }, "nodes[0].mesh: must be a number"),
      bent(
          "mesh_is_fraction", [](Model& m) { m.json["nodes"][0]["mesh"] = 0.5; },
          "nodes[0].mesh: is 0.5, but must be a whole number"),
      bent(
          "matrix_short",
          [](Model& m) {
            m.json["nodes"][0]["matrix"] = {1, 2, 3};
          },
          "nodes[0].matrix: must have 16 numbers"),
      bent(
          "matrix_projective", [](Model& m) { m.json["nodes"][0]["matrix"] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; },
          "is not an affine transform"),
      bent(
          "rotation_zero",
          [](Model& m) {
            m.json["nodes"][0]["rotation"] = {0, 0, 0, 0};
          },
          "is not a rotation"),
      bent(
          "index_past_end",
          [](Model& m) {
            m.primitive()["indices"] = m.add_indices({0, 1, 3});
          },
          "vertex 3 is used, but there are 3"),
      bent(
          "index_restart",
          [](Model& m) {
            m.primitive()["indices"] = m.add_indices({0, 1, 65535});
          },
          "vertex 65535 is used"),
      bent(
          "indices_float",
          [](Model& m) {
            m.primitive()["indices"] = m.add_floats({0, 1, 2}, 1);
          },
          "indices must be unsigned integers"),
      bent(
          "mode_99", [](Model& m) { m.primitive()["mode"] = 99; }, "meshes[0].primitives[0].mode: is 99"),
      bent(
          "accessor_past_view", [](Model& m) { m.json["accessors"][0]["count"] = 4; },
          "accessors[0]: its bytes 0 to 48 lie outside its buffer view of 36"),
      bent(
          "accessor_count_huge", [](Model& m) { m.json["accessors"][0]["count"] = 1e18; }, "accessors[0].count: is 1e+18"),
      bent(
          "accessor_offset_huge", [](Model& m) { m.json["accessors"][0]["byteOffset"] = 18446744073709551615u; },
          "accessors[0].byteOffset: is 1.8"),
      bent(
          "accessor_count_zero", [](Model& m) { m.json["accessors"][0]["count"] = 0; }, "accessors[0].count: is 0"),
      bent(
          "component_type_unknown", [](Model& m) { m.json["accessors"][0]["componentType"] = 5124; },
          "5124 is not a component type"),
      bent(
          "type_unknown", [](Model& m) { m.json["accessors"][0]["type"] = "VEC9"; },
          "its type \"VEC9\" is not one that is read here"),
      bent(
          "positions_vec2", [](Model& m) { m.json["accessors"][0]["type"] = "VEC2"; },
          "accessor 0 has 2 components, needed are 3"),
      bent(
          "view_past_buffer", [](Model& m) { m.json["bufferViews"][0]["byteLength"] = 99999; }, "lie outside its buffer"),
      bent(
          "view_offset_overflow", [](Model& m) { m.json["bufferViews"][0]["byteOffset"] = 1099511627775; },
          "lie outside its buffer"),
      bent(
          "stride_below_element", [](Model& m) { m.json["bufferViews"][0]["byteStride"] = 4; },
          "its stride of 4 bytes is less than its element of 12"),
      bent(
          "stride_past_end", [](Model& m) { m.json["bufferViews"][0]["byteStride"] = 252; }, "lie outside its buffer view of 36"),
      bent(
          "buffer_without_data",
          [](Model& m) {
            m.json["buffers"] = {{{"byteLength", 1 << 20}}};
          },
          "promises 1048576 bytes, but there are"),
      bent(
          "buffer_missing_file",
          [](Model& m) {
            m.json["buffers"] = {{{"byteLength", 44}, {"uri", "nowhere.bin"}}};
          },
          "nowhere.bin: there is no such file"),
      bent(
          "uri_absolute",
          [](Model& m) {
            m.json["buffers"] = {{{"byteLength", 44}, {"uri", "/etc/passwd"}}};
          },
          "\"/etc/passwd\" is an absolute path"),
      bent(
          "uri_above",
          [](Model& m) {
            m.json["buffers"] = {{{"byteLength", 44}, {"uri", "../../etc/passwd"}}};
          },
          "leads out of the scene's folder"),
      bent(
          "uri_above_encoded",
          [](Model& m) {
            m.json["buffers"] = {{{"byteLength", 44}, {"uri", "%2e%2E/x.bin"}}};
          },
          "leads out of the scene's folder"),
      bent(
          "uri_scheme",
          [](Model& m) {
            m.json["buffers"] = {{{"byteLength", 44}, {"uri", "http://example.org/x.bin"}}};
          },
          "has a scheme"),
      bent(
          "uri_zero_byte",
          [](Model& m) {
            m.json["buffers"] = {{{"byteLength", 44}, {"uri", "x%00.bin"}}};
          },
          "holds a zero byte"),
      bent(
          "uri_percent_broken",
          [](Model& m) {
            m.json["buffers"] = {{{"byteLength", 44}, {"uri", "x%2"}}};
          },
          "has a broken percent-encoding"),
      bent(
          "uri_is_folder",
          [](Model& m) {
            m.json["buffers"] = {{{"byteLength", 44}, {"uri", "."}}};
          },
          "this is not a file"),
      bent(
          "data_uri_not_base64",
          [](Model& m) {
            m.json["buffers"] = {{{"byteLength", 44}, {"uri", "data:;base64,@@@@"}}};
          },
          "has a character that is not base64"),
      bent(
          "data_uri_short",
          [](Model& m) {
            m.json["buffers"] = {{{"byteLength", 44}, {"uri", "data:;base64,AAAA"}}};
          },
          "promises 44 bytes, but there are 3"),
      bent(
          "position_nan",
          [](Model& m) {
            m.primitive()["attributes"]["POSITION"] = m.add_floats({0, 0, 0, 1, kNan, 0, 0, 1, 0}, 3);
          },
          "element 1 is not a finite number"),
      bent(
          "position_infinite",
          [](Model& m) {
            m.primitive()["attributes"]["POSITION"] = m.add_floats({0, 0, 0, 1, INFINITY, 0, 0, 1, 0}, 3);
          },
          "element 1 is not a finite number"),
      bent(
          "position_far",
          [](Model& m) {
            m.primitive()["attributes"]["POSITION"] = m.add_floats({0, 0, 0, 1e30f, 0, 0, 0, 1, 0}, 3);
          },
          "a vertex lies farther than 1e12 metres away"),
      bent(
          "normals_too_few",
          [](Model& m) {
            m.primitive()["attributes"]["NORMAL"] = m.add_floats({0, 0, 1}, 3);
          },
          "has 1 elements, but there are 3 positions"),
      bent(
          "sparse_past_end",
          [](Model& m) {
            const int at = m.add_view(std::string("\x05", 1)), to = m.add_view(std::string(12, '\0'));
            m.json["accessors"][0]["sparse"] = {
                {"count", 1}, {"indices", {{"bufferView", at}, {"componentType", 5121}}}, {"values", {{"bufferView", to}}}};
          },
          "must ascend and stay below the accessor's count"),
      bent(
          "sparse_count_huge",
          [](Model& m) {
            m.json["accessors"][0]["sparse"] = {
                {"count", 1000}, {"indices", {{"bufferView", 0}, {"componentType", 5121}}}, {"values", {{"bufferView", 0}}}};
          },
          "accessors[0].sparse.count: is 1000"),
      bent(
          "many_instances",
          [](Model& m) {  // a small file, a large scene
            m.json["accessors"].push_back({{"componentType", 5126}, {"count", 3000000}, {"type", "VEC3"}});
            m.primitive() = {{"attributes", {{"POSITION", 2}}}};
            for (int i = 1; i < 3000; ++i) {
              m.json["nodes"].push_back({{"mesh", 0}});
              m.json["scenes"][0]["nodes"].push_back(i);
            }
          },
          "the scene has more than 20 million vertices or triangles"),
      bent(
          "many_primitives",
          [](Model& m) {
            for (int i = 0; i < 300; ++i) m.json["meshes"][0]["primitives"].push_back(m.json["meshes"][0]["primitives"][0]);
            for (int i = 1; i < 4000; ++i) {
              m.json["nodes"].push_back({{"mesh", 0}});
              m.json["scenes"][0]["nodes"].push_back(i);
            }
          },
          "the model needs more than 4 GiB of memory"),
      bent(
          "material_out_of_range", [](Model& m) { m.primitive()["material"] = 3; }, "material: is 3, but there are 1 materials"),
      bent(
          "base_color_wild",
          [](Model& m) {
            m.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 2, 3, 4};
          },
          "is 2, but must lie between"),
      bent(
          "ior_below_1", [](Model& m) { m.json["materials"][0]["extensions"]["KHR_materials_ior"]["ior"] = 0.5; },
          "must be 0 or at least 1"),
      bent(
          "texture_out_of_range", [](Model& m) { m.json["materials"][0]["normalTexture"]["index"] = 8; },
          "normalTexture.index: is 8, but there are 0 textures"),
      bent(
          "picture_is_text",
          [](Model& m) {
            add_texture(m, {{"bufferView", m.add_view("hello, picture")}});
          },
          "images[0]: is not a PNG, JPEG or WebP picture"),
      bent(
          "picture_cut",
          [](Model& m) {
            add_texture(m, {{"bufferView", m.add_view(png_header(4, 4))}});
          },
          "images[0]: is a damaged PNG picture"),
      bent(
          "picture_huge",
          [](Model& m) {
            add_texture(m, {{"bufferView", m.add_view(png_header(16000, 16000))}});
          },
          "is a picture of 16000 x 16000 pixels, more than is read"),
      bent(
          "picture_endless",
          [](Model& m) {
            add_texture(m, {{"bufferView", m.add_view(png_header(0x7FFFFFFF, 1))}});
          },
          "images[0]: is a damaged PNG picture"),
      bent(
          "picture_missing",
          [](Model& m) {
            add_texture(m, {{"uri", "gone\n.png"}});
          },
          "gone?.png: there is no such file"),
      bent(
          "joint_out_of_range",
          [](Model& m) {
            m.json["skins"] = {{{"joints", {0}}}};
            m.json["nodes"][0]["skin"] = 0;
            m.primitive()["attributes"]["JOINTS_0"] = m.add_accessor(m.add_view(std::string(12, '\x07')), 5121, 3, "VEC4");
            m.primitive()["attributes"]["WEIGHTS_0"] = m.add_floats(std::vector<float>(12, 0.25f), 4);
          },
          "hangs on joint 7, but its skin has 1"),
      bent(
          "camera_flat",
          [](Model& m) {
            m.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0}, {"znear", 1}}}}};
            m.json["nodes"][0]["camera"] = 0;
          },
          "cameras[0].perspective.yfov: is 0"),
      bent(
          "light_unknown",
          [](Model& m) {
            m.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "moon"}}};
            m.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
          },
          "\"moon\" is not directional, point or spot"),
      bent(
          "scene_out_of_range", [](Model& m) { m.json["scene"] = 9; }, "scene: is 9, but there are 1 scenes"),
      bent(
          "nothing_to_see", [](Model& m) { m.json["scenes"][0]["nodes"] = json::array(); }, "there is nothing to see in it"),
  };
  return models;
}

TEST(HostileGltf, EveryOffenceGetsOneLineThatNamesIt) {
  for (const HostileModel& hostile : hostile_models()) {
    SCOPED_TRACE(hostile.name);
    const Folder folder;
    folder.write("model.glb", hostile.bytes());
    folder.write("scene.toml", "scene = \"model.glb\"\n");
    const test::CpuTimer timer;
    const std::string error = test::error_of([&] { load_scene(folder.path()); });
    EXPECT_LT(timer.seconds(), test::kHangSeconds);
    EXPECT_NE(error.find(hostile.error), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    EXPECT_EQ(error.rfind(folder.path().string(), 0), 0u) << "the error must begin with the file: " << error;
    EXPECT_LT(error.size(), 700u);
  }
}

TEST(HostileGltf, AnimationsThatCannotDriveAnAxisSayWhy) {
  struct Case {
    std::vector<float> times, values;
    json target;
    const char* error;
  };
  const Case cases[] = {
      {{0, 0}, {0, 0, 0, 1, 1, 1}, {{"node", 0}, {"path", "translation"}}, "key times must ascend, but key 1 does not"},
      {{-1, 1}, {0, 0, 0, 1, 1, 1}, {{"node", 0}, {"path", "translation"}}, "key times must not be negative"},
      {{0, kNan}, {0, 0, 0, 1, 1, 1}, {{"node", 0}, {"path", "translation"}}, "element 1 is not a finite number"},
      {{0, 1}, {0, 0, 0}, {{"node", 0}, {"path", "translation"}}, "has 1 values, but its 2 keys need 2"},
      {{0, 1}, {0, 0, 0, 1, 1, 1}, {{"node", 7}, {"path", "translation"}}, "target.node: is 7, but there are 1 nodes"},
      {{0, 1}, {0, 0, 0, 1, 1, 1}, {{"node", 0}, {"path", "weights"}}, "moves morph weights of node 0, which has no morph targets"},
      {{0, 1}, {0, 0, 0, 1, 1, 1}, {{"node", 0}, {"path", "pointer"}}, "moves no node of the scene"},
      {{0, 1}, {0, 0, 0, 1, 1, 1}, {{"node", 0}, {"path", "rotation"}}, "has 3 components, needed are 4"},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.error);
    const Folder folder;
    Model m = Model::triangle();
    add_animation(m, c.times, c.values, c.target);
    const std::string error =
        test::error_of([&] { test::load(folder, m, "[[axis]]\nname = \"a\"\nanimation = \"a\"\nsamples = 4\n"); });
    EXPECT_NE(error.find(c.error), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

// A model with a texture, a skin, an animation, sparse data: every part of the reader has something to trip over.
Model rich_model() {
  Model m = Model::triangle();
  m.primitive()["attributes"]["TEXCOORD_0"] = m.add_floats({0, 0, 1, 0, 0, 1}, 2);
  m.primitive()["attributes"]["NORMAL"] = m.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  m.primitive()["attributes"]["JOINTS_0"] = m.add_accessor(m.add_view(std::string(12, '\0')), 5121, 3, "VEC4");
  m.primitive()["attributes"]["WEIGHTS_0"] = m.add_floats(std::vector<float>(12, 0.25f), 4);
  m.primitive()["targets"] = {{{"POSITION", 0}}};
  m.json["meshes"][0]["weights"] = {0.5};
  m.json["nodes"].push_back({{"name", "bone"}, {"translation", {0, 1, 0}}});
  m.json["scenes"][0]["nodes"].push_back(1);
  m.json["skins"] = {{{"joints", {1}}}};
  m.json["nodes"][0]["skin"] = 0;
  m.json["nodes"].push_back({{"name", "mover"}, {"mesh", 0}, {"scale", {1, 2, 3}}});
  m.json["scenes"][0]["nodes"].push_back(2);
  add_animation(m, {0, 1}, {0, 0, 0, 1, 1, 1}, {{"node", 2}, {"path", "translation"}});
  json& animation = m.json["animations"][0];  // moves the bone and drives the weights, too
  animation["channels"].push_back({{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}});
  animation["samplers"].push_back({{"input", animation["samplers"][0]["input"]}, {"output", m.add_floats({0, 1}, 1)}});
  animation["channels"].push_back({{"sampler", 1}, {"target", {{"node", 0}, {"path", "weights"}}}});
  const int at = m.add_view(std::string("\x01", 1)), to = m.add_view(std::string(12, '\x3f'));
  m.json["accessors"][0]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", at}, {"componentType", 5121}}}, {"values", {{"bufferView", to}}}};
  return m;
}

TEST(HostileGltf, RandomDamageNeverCrashesAndAlwaysGivesOneLine) {
  const Folder folder;
  const std::string whole = rich_model().glb();
  folder.write("scene.toml", "scene = \"model.glb\"\n[[axis]]\nname = \"a\"\nanimation = \"a\"\nsamples = 4\n");
  folder.write("model.glb", whole);
  ASSERT_EQ(test::error_of([&] { load_scene(folder.path()); }), "");
  ASSERT_NE(load_scene(folder.path())->objects[0].deformation, nullptr);
  std::mt19937 random(20260101);
  int refused = 0;
  constexpr int kRounds = 1500;
  for (int round = 0; round < kRounds; ++round) {
    std::string damaged = whole;
    const int changes = 1 + static_cast<int>(random() % 3);
    for (int c = 0; c < changes; ++c) {
      static const char kJson[] = "0123456789-.,:[]{}\"eE";
      char& byte = damaged[random() % damaged.size()];
      byte = random() % 2 ? kJson[random() % (sizeof(kJson) - 1)] : static_cast<char>(random());
    }
    if (random() % 16 == 0) damaged.resize(random() % damaged.size());
    folder.write("model.glb", damaged);
    const std::string error = test::error_of([&] {
      const auto scene = load_scene(folder.path());
      const Pose pose = pose_scene(*scene, {0.5f});
      for (size_t o = 0; o < scene->objects.size(); ++o)
        if (scene->objects[o].deformation) deformed_mesh(*scene, pose, static_cast<int>(o));
    });
    refused += !error.empty();
    ASSERT_EQ(error.find('\n'), std::string::npos) << error;
  }
  EXPECT_GT(refused, kRounds / 3);
}

}  // namespace
}  // namespace vitrine
