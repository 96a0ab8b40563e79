// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/sample_model.h"

#include <nlohmann/json.hpp>

#include "host/scene/shapes.h"

namespace vitrine {
namespace {

using Json = nlohmann::ordered_json;

class GlbWriter {
 public:
  GlbWriter() {
    json_["asset"] = {{"version", "2.0"}, {"generator", "vitrine new"}};
    json_["scene"] = 0;
    json_["scenes"] = Json::array({{{"nodes", Json::array()}}});
    for (const char* key : {"nodes", "meshes", "materials", "accessors", "bufferViews"}) json_[key] = Json::array();
  }

  void add(const std::string& name, const Geometry& g, const glm::vec3& at, const glm::vec3& color, float roughness) {
    const size_t number = json_["nodes"].size();
    json_["materials"].push_back(
        {{"name", name},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {color.x, color.y, color.z, 1}}, {"metallicFactor", 0}, {"roughnessFactor", roughness}}}});
    Json attributes;
    attributes["POSITION"] = accessor(g.positions, 5126, "VEC3");
    json_["accessors"].back()["min"] = extreme(g, -1);
    json_["accessors"].back()["max"] = extreme(g, 1);
    attributes["NORMAL"] = accessor(g.normals, 5126, "VEC3");
    attributes["TEXCOORD_0"] = accessor(g.texcoords[0], 5126, "VEC2");
    const size_t indices = accessor(g.indices, 5125, "SCALAR");
    json_["meshes"].push_back(
        {{"name", name},
         {"primitives", Json::array({{{"attributes", attributes}, {"indices", indices}, {"material", number}}})}});
    json_["nodes"].push_back({{"name", name}, {"mesh", number}, {"translation", {at.x, at.y, at.z}}});
    json_["scenes"][0]["nodes"].push_back(number);
  }

  std::string finish() {
    json_["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
    std::string text = json_.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string glb = "glTF" + u32(2) + u32(12 + 8 + text.size() + 8 + binary_.size());
    return glb + u32(text.size()) + "JSON" + text + u32(binary_.size()) + std::string("BIN\0", 4) + binary_;
  }

 private:
  static std::string u32(size_t value) {
    std::string bytes(4, '\0');
    for (size_t i = 0; i < 4; ++i) bytes[i] = static_cast<char>(value >> (8 * i));
    return bytes;
  }

  template <typename T>
  size_t accessor(const std::vector<T>& values, int component_type, const char* type) {
    const size_t bytes = values.size() * sizeof(T);
    json_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes}});
    binary_.append(reinterpret_cast<const char*>(values.data()), bytes);
    json_["accessors"].push_back({{"bufferView", json_["bufferViews"].size() - 1},
                                  {"componentType", component_type},
                                  {"count", values.size()},
                                  {"type", type}});
    return json_["accessors"].size() - 1;
  }

  static Json extreme(const Geometry& g, float sign) {
    glm::vec3 most = g.positions[0];
    for (const glm::vec3& p : g.positions) most = sign < 0 ? glm::min(most, p) : glm::max(most, p);
    return {most.x, most.y, most.z};
  }

  Json json_;
  std::string binary_;
};

}  // namespace

std::string sample_model_glb() {
  GlbWriter writer;
  writer.add("plinth", make_box({1.0f, 0.2f, 0.7f}), {0, 0.1f, 0}, {0.72f, 0.70f, 0.67f}, 0.45f);
  writer.add("ball", make_sphere(0.2f, 48, 24), {-0.22f, 0.4f, 0.02f}, {0.60f, 0.06f, 0.05f}, 0.15f);
  writer.add("cube", make_box(glm::vec3(0.28f)), {0.24f, 0.34f, -0.04f}, {0.08f, 0.24f, 0.50f}, 0.35f);
  return writer.finish();
}

}  // namespace vitrine
