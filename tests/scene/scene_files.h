// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Scenes made by hand for the tests: a folder that disappears, a model as JSON and bytes.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <glm/geometric.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/base/error.h"
#include "host/scene/scene.h"

namespace vitrine::test {

// A folder of its own for every test, removed at its end.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "vitrine_scene_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  void write(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << bytes;
  }

 private:
  std::filesystem::path path_;
};

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

inline std::string u32(uint32_t value) { return bytes_of(std::vector<uint32_t>{value}); }

// A glTF model in the making: views and accessors are appended, the rest of the JSON is free to be bent.
struct Model {
  nlohmann::json json;
  std::string binary;

  // One triangle (0,0,0) (1,0,0) (0,1,0) on node 0 named "thing" with material 0.
  static Model triangle() {
    Model m;
    m.json = {{"asset", {{"version", "2.0"}}},          {"scene", 0},
              {"scenes", {{{"nodes", {0}}}}},           {"nodes", {{{"name", "thing"}, {"mesh", 0}}}},
              {"materials", {{{"name", "paint"}}}},     {"buffers", nlohmann::json::array()},
              {"bufferViews", nlohmann::json::array()}, {"accessors", nlohmann::json::array()}};
    const int positions = m.add_floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
    const int indices = m.add_indices({0, 1, 2});
    m.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"material", 0}}}}}};
    return m;
  }

  int add_view(const std::string& bytes) {
    binary.resize((binary.size() + 3) / 4 * 4);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes.size()}});
    binary += bytes;
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }
  int add_accessor(int view, int component_type, size_t count, const std::string& type) {
    json["accessors"].push_back({{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
    return static_cast<int>(json["accessors"].size()) - 1;
  }
  int add_floats(const std::vector<float>& values, size_t components) {
    static const char* kTypes[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    return add_accessor(add_view(bytes_of(values)), 5126, values.size() / components,
                        components == 16 ? "MAT4" : kTypes[components]);
  }
  int add_indices(const std::vector<uint16_t>& values) {
    return add_accessor(add_view(bytes_of(values)), 5123, values.size(), "SCALAR");
  }
  nlohmann::json& primitive() { return json["meshes"][0]["primitives"][0]; }

  // As .glb; the buffer's length is filled in where the JSON does not say it.
  std::string glb() const {
    nlohmann::json out = json;
    if (out["buffers"].empty() && !binary.empty()) out["buffers"].push_back({{"byteLength", binary.size()}});
    return glb_of(out.dump());
  }
  std::string glb_of(std::string text) const {
    std::string data = binary;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    data.resize((data.size() + 3) / 4 * 4, '\0');
    const auto length = [](const std::string& s) { return u32(static_cast<uint32_t>(s.size())); };
    const std::string chunks = length(text) + "JSON" + text + length(data) + std::string("BIN\0", 4) + data;
    return "glTF" + u32(2) + u32(static_cast<uint32_t>(12 + chunks.size())) + chunks;
  }
};

// Loads DIR/scene.toml that names model.glb, after `toml`.
inline std::unique_ptr<const Scene> load(const Folder& folder, const Model& model, const std::string& toml = "") {
  folder.write("model.glb", model.glb());
  folder.write("scene.toml", "scene = \"model.glb\"\n" + toml);
  return load_scene(folder.path());
}

inline void expect_near(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-5f) {
  EXPECT_LT(glm::distance(a, b), tolerance) << a.x << ' ' << a.y << ' ' << a.z;
}

// What a hostile file may cost before it counts as a hang: seconds of processor time, ample under sanitizers.
inline constexpr double kHangSeconds = 60;

// Processor time of this process: does not count the neighbours on a loaded machine.
class CpuTimer {
 public:
  double seconds() const { return static_cast<double>(std::clock() - begin_) / CLOCKS_PER_SEC; }

 private:
  std::clock_t begin_ = std::clock();
};

// The error that `action` ends with; empty where it has none.
inline std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

}  // namespace vitrine::test
