// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Real models and probes by many makers, good and bad.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "host/base/error.h"
#include "host/scene/environment.h"
#include "host/scene/gltf.h"
#include "tests/scene/scene_files.h"

namespace vitrine {
namespace {

namespace fs = std::filesystem;
const fs::path kAssets = fs::path(VITRINE_EXTRA_ASSETS) / "assets";

std::vector<fs::path> files_below(const fs::path& folder, const std::vector<std::string>& extensions) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (std::find(extensions.begin(), extensions.end(), entry.path().extension()) != extensions.end())
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

bool is_bad(const fs::path& file) { return file.string().find("/bad/") != std::string::npos; }

// The error of a reading, "" for none; fails the test where it is slow or its message has more than one line.
template <typename Read>
std::string outcome(const fs::path& file, Read read) {
  const test::CpuTimer timer;
  std::string error;
  try {
    read();
  } catch (const InputError& e) {
    error = e.what();
    EXPECT_GT(error.size(), file.string().size()) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    EXPECT_LT(error.size(), 1000u) << error;
  }
  EXPECT_LT(timer.seconds(), test::kHangSeconds) << file;
  return error;
}

GltfModel read_model(const fs::path& file, const std::vector<std::string>& animations = {}) {
  return read_gltf({file, file.parent_path(), {}, animations, nullptr});
}

// What every stage after the loader takes for granted.
void expect_sound(const GltfModel& model) {
  for (size_t n = 0; n < model.nodes.size(); ++n) ASSERT_LT(model.nodes[n].parent, static_cast<int>(n));
  for (const Object& object : model.objects) {
    const Geometry& g = object.geometry;
    ASSERT_EQ(g.indices.size(), 3 * g.triangle_materials.size());
    ASSERT_EQ(g.normals.size(), g.positions.size());
    for (const uint32_t i : g.indices) ASSERT_LT(i, g.positions.size());
    for (const auto* uv : {&g.texcoords[0], &g.texcoords[1]}) ASSERT_TRUE(uv->empty() || uv->size() == g.positions.size());
    ASSERT_TRUE(g.tangents.empty() || g.tangents.size() == g.positions.size());
    ASSERT_TRUE(g.colors.empty() || g.colors.size() == g.positions.size());
    for (const glm::vec3& n : g.normals) ASSERT_NEAR(glm::length(n), 1, 1e-4);
    for (const int m : g.triangle_materials) {
      ASSERT_LT(m, static_cast<int>(model.materials.size()));
      const Material& material = model.materials[static_cast<size_t>(m)];
      for (const TextureRef* ref : {&material.base_color_texture, &material.normal_texture, &material.emissive_texture}) {
        if (!*ref) continue;
        ASSERT_LT(ref->image, static_cast<int>(model.images.size()));
        ASSERT_EQ(g.texcoords[static_cast<size_t>(ref->texcoord)].size(), g.positions.size());
      }
      if (material.normal_texture) {
        ASSERT_EQ(g.tangents.size(), g.positions.size());
      }
    }
  }
}

#define SKIP_WITHOUT_ASSETS() \
  if (!fs::exists(kAssets))   \
  GTEST_SKIP() << "no assets at " << kAssets << " (VITRINE_EXTRA_ASSETS): real models and probes are not tested"

TEST(Corpus, GoodModelsLoadOrAreRefusedForAnExtensionOnly) {
  SKIP_WITHOUT_ASSETS();
  int loaded = 0, refused = 0;
  for (const fs::path& file : files_below(kAssets / "gltf", {".glb", ".gltf"})) {
    if (is_bad(file)) continue;
    SCOPED_TRACE(file.string());
    GltfModel model;
    const std::string error = outcome(file, [&] { model = read_model(file); });
    if (error.empty()) {
      ++loaded;
      expect_sound(model);
      continue;
    }
    ++refused;
    const bool extension = error.find("extensionsRequired: the model requires \"") != std::string::npos;
    const bool version = file.filename() == "Compatibility_04.gltf" && error.find("minVersion: is \"2.1\"") != std::string::npos;
    EXPECT_TRUE(extension || version) << error;
  }
  std::cout << loaded << " models loaded, " << refused << " refused for an extension or version\n";
  EXPECT_GE(loaded, 60);
}

TEST(Corpus, BadModelsNeverCrashHangOrFillTheScreen) {
  SKIP_WITHOUT_ASSETS();
  int loaded = 0, refused = 0;
  for (const fs::path& file : files_below(kAssets / "gltf" / "bad", {".glb", ".gltf"})) {
    SCOPED_TRACE(file.string());
    GltfModel model;
    const std::string error = outcome(file, [&] {
      model = read_model(file);
      model = read_model(file, model.animation_names);
    });
    error.empty() ? ++loaded : ++refused;
    if (error.empty()) expect_sound(model);
    if (std::getenv("VITRINE_SHOW"))
      std::cout << file.lexically_relative(kAssets).string() << ": " << (error.empty() ? "ok" : error) << "\n";
  }
  std::cout << loaded << " bad models loaded, " << refused << " refused\n";
  EXPECT_GE(refused, 70);
}

// One triangle per material, out of a buffer of its own.
template <typename AddNode>
void add_triangles_for_materials(nlohmann::json& document, size_t materials, AddNode add_node) {
  for (const char* key : {"buffers", "bufferViews", "accessors", "meshes"})
    if (!document.contains(key) || !document[key].is_array()) document[key] = nlohmann::json::array();
  document["buffers"].push_back({{"byteLength", 36}, {"uri", "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}});
  document["bufferViews"].push_back({{"buffer", document["buffers"].size() - 1}, {"byteLength", 36}});
  document["accessors"].push_back(
      {{"bufferView", document["bufferViews"].size() - 1}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  for (size_t m = 0; m < materials; ++m) {
    const nlohmann::json primitive = {{"attributes", {{"POSITION", document["accessors"].size() - 1}}}, {"material", m}};
    document["meshes"].push_back({{"primitives", {primitive}}});
    add_node({{"mesh", document["meshes"].size() - 1}});
  }
}

// Adds nodes that use every mesh, skin, camera, light and material of a model: what lies unused is not read otherwise.
void use_everything(nlohmann::json& document) {
  const auto list = [&](const char* key) { return document.contains(key) && document[key].is_array() ? document[key].size() : 0; };
  nlohmann::json roots = nlohmann::json::array();
  const auto add_node = [&](nlohmann::json node) {
    roots.push_back(list("nodes"));
    document["nodes"].push_back(std::move(node));
  };
  if (!document.contains("nodes") || !document["nodes"].is_array()) document["nodes"] = nlohmann::json::array();
  for (size_t m = 0; m < list("meshes"); ++m) {
    add_node({{"mesh", m}});
    for (size_t s = 0; s < list("skins"); ++s) add_node({{"mesh", m}, {"skin", s}});
  }
  for (size_t c = 0; c < list("cameras"); ++c) add_node({{"camera", c}});
  const size_t lights = document.value("/extensions/KHR_lights_punctual/lights"_json_pointer, nlohmann::json::array()).size();
  for (size_t l = 0; l < lights; ++l) add_node({{"extensions", {{"KHR_lights_punctual", {{"light", l}}}}}});
  add_triangles_for_materials(document, list("materials"), add_node);
  document["scenes"] = {{{"nodes", roots}}};
  document["scene"] = 0;
}

TEST(Corpus, BadModelsAllOfWhosePartsAreUsedNeverCrashHangOrFillTheScreen) {
  SKIP_WITHOUT_ASSETS();
  int loaded = 0, refused = 0;
  for (const fs::path& file : files_below(kAssets / "gltf" / "bad", {".gltf"})) {
    SCOPED_TRACE(file.string());
    const Bytes bytes = read_file(file, 1 << 20);
    nlohmann::json document = nlohmann::json::parse(bytes.begin(), bytes.end(), nullptr, false);
    if (!document.is_object()) continue;
    use_everything(document);
    const std::string text = document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    const Bytes changed(text.begin(), text.end());
    GltfModel model;
    const std::string error = outcome(file, [&] { model = read_gltf({file, {}, {}, {}, &changed}); });
    error.empty() ? ++loaded : ++refused;
    if (error.empty()) expect_sound(model);
    if (std::getenv("VITRINE_SHOW"))
      std::cout << "+" << file.lexically_relative(kAssets).string() << ": " << (error.empty() ? "ok" : error) << "\n";
  }
  std::cout << loaded << " bad models loaded, " << refused << " refused\n";
  EXPECT_GE(refused, 45);
}

TEST(Corpus, ReferenceScenesLoad) {
  SKIP_WITHOUT_ASSETS();
  for (const fs::path& file : files_below(fs::path(VITRINE_EXTRA_ASSETS) / "reference", {".toml"})) {
    SCOPED_TRACE(file.string());
    std::unique_ptr<const Scene> scene;
    EXPECT_EQ(outcome(file, [&] { scene = load_scene(file); }), "");
    if (!scene) continue;
    EXPECT_FALSE(scene->objects.empty());
    EXPECT_GT(scene->camera.far_distance, scene->camera.near_distance);
  }
}

TEST(Corpus, ThreeContainersOfOneModelAgree) {
  SKIP_WITHOUT_ASSETS();
  const GltfModel binary = read_model(kAssets / "gltf/teapot-binary.glb"),
                  embedded = read_model(kAssets / "gltf/teapot-embedded.gltf"),
                  separate = read_model(kAssets / "gltf/teapot-separate/teapot-separate.gltf");
  for (const GltfModel* other : {&embedded, &separate}) {
    ASSERT_EQ(other->objects.size(), binary.objects.size());
    for (size_t o = 0; o < binary.objects.size(); ++o) {
      EXPECT_EQ(other->objects[o].geometry.positions, binary.objects[o].geometry.positions);
      EXPECT_EQ(other->objects[o].geometry.indices, binary.objects[o].geometry.indices);
    }
    ASSERT_EQ(other->images.size(), binary.images.size());
    for (size_t i = 0; i < binary.images.size(); ++i) EXPECT_EQ(other->images[i].rgba, binary.images[i].rgba);
  }
}

TEST(Corpus, DamagedExrNeverCrashesHangsOrFillsTheScreen) {
  SKIP_WITHOUT_ASSETS();
  int loaded = 0, refused = 0;
  for (const fs::path& file : files_below(kAssets / "env" / "bad-exr", {".exr"})) {
    SCOPED_TRACE(file.string());
    std::vector<std::string> warnings;
    Environment environment;
    const std::string error = outcome(file, [&] { environment = read_environment(file, &warnings); });
    error.empty() ? ++loaded : ++refused;
    for (const glm::vec3& texel : environment.radiance)
      for (int c = 0; c < 3; ++c) ASSERT_TRUE(texel[c] >= 0 && texel[c] <= kBrightestTexel);
  }
  std::cout << loaded << " damaged probes loaded, " << refused << " refused\n";
  EXPECT_GE(refused, 60);
}

TEST(Corpus, GoodProbesLoad) {
  SKIP_WITHOUT_ASSETS();
  for (const fs::path& file : files_below(kAssets / "env", {".exr", ".hdr"})) {
    if (file.string().find("bad-exr") != std::string::npos) continue;
    SCOPED_TRACE(file.string());
    std::vector<std::string> warnings;
    Environment environment;
    EXPECT_EQ(outcome(file, [&] { environment = read_environment(file, &warnings); }), "");
    EXPECT_EQ(environment.radiance.size(), static_cast<size_t>(environment.width) * static_cast<size_t>(environment.height));
    for (const glm::vec3& texel : environment.radiance)
      for (int c = 0; c < 3; ++c) ASSERT_TRUE(texel[c] >= 0 && texel[c] <= kBrightestTexel);
  }
}

}  // namespace
}  // namespace vitrine
