// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/gltf.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "formats/image.h"
#include "host/base/error.h"
#include "host/scene/gltf_animations.h"
#include "host/scene/gltf_materials.h"
#include "host/scene/gltf_meshes.h"
#include "host/scene/gltf_nodes.h"
#include "host/scene/text.h"

namespace vitrine {
namespace {

constexpr double kBrightest = 1e9;

std::vector<std::string> variant_names(const GltfDocument& document) {
  std::vector<std::string> names;
  const auto extension = document.root().extension("KHR_materials_variants");
  if (!extension) return names;
  const JsonView variants = extension->at("variants");
  for (size_t v = 0; v < variants.size(); ++v) names.push_back(variants[v].at("name").text());
  return names;
}

// Position of `name` in `names`; fails with the nearest one.
int find_name(const std::string& file, const std::string& what, const std::string& name, const std::vector<std::string>& names) {
  const auto it = std::find(names.begin(), names.end(), name);
  if (it != names.end()) return static_cast<int>(it - names.begin());
  const std::string remedy =
      names.empty() ? "the file has none" : "did you mean " + in_quotes(nearest_word(name, names)) + "? It has " + joined(names);
  throw InputError(file, fmt::format("there is no {} {}", what, in_quotes(name)), remedy);
}

GltfCamera read_camera(const JsonView& place) {
  GltfCamera camera;
  const std::string type = place.at("type").text();
  if (type == "perspective") {
    camera.yfov = static_cast<float>(place.at(type.c_str()).at("yfov").number(1e-3, 3.14));
  } else if (type == "orthographic") {
    camera.perspective = false;
    camera.ymag = static_cast<float>(place.at(type.c_str()).at("ymag").number(1e-9, 1e9));
  } else {
    place.at("type").fail(in_quotes(type) + " is not perspective or orthographic");
  }
  return camera;
}

void read_spot(const JsonView& place, Light& light) {
  constexpr double kRightAngle = std::numbers::pi / 2;
  light.outer_cone = static_cast<float>(kRightAngle / 2);
  if (const auto spot = place.find("spot")) {
    light.inner_cone = static_cast<float>(spot->number_or("innerConeAngle", 0, 0, kRightAngle));
    light.outer_cone = static_cast<float>(spot->number_or("outerConeAngle", kRightAngle / 2, 0, kRightAngle + 1e-6));
  }
  if (light.inner_cone >= light.outer_cone) place.fail("the inner cone must be smaller than the outer");
}

// KHR_lights_punctual.
Light read_light(const JsonView& place) {
  Light light;
  std::array<float, 3> color{1, 1, 1};
  if (const auto member = place.find("color")) member->numbers(color, 0, kBrightest);
  light.intensity = glm::vec3(color[0], color[1], color[2]) * static_cast<float>(place.number_or("intensity", 1, 0, kBrightest));
  light.range = static_cast<float>(place.number_or("range", 0, 0, 1e12));
  const std::string type = place.at("type").text();
  if (type == "directional")
    light.kind = LightKind::kDirectional;
  else if (type == "point")
    light.kind = LightKind::kPoint;
  else if (type == "spot")
    light.kind = LightKind::kSpot;
  else
    place.at("type").fail(in_quotes(type) + " is not directional, point or spot");
  if (light.kind == LightKind::kSpot) read_spot(place, light);
  return light;
}

class GltfReader {
 public:
  explicit GltfReader(const GltfRequest& request)
      : request_(request),
        document_(request.model, request.root, request.bytes, &model_.warnings),
        nodes_(read_nodes(document_)),
        materials_(document_, &model_.materials, &model_.images),
        moves_(nodes_.order.size(), false),
        morphs_(nodes_.order.size(), false) {}

  GltfModel read() {
    model_.nodes = nodes_.rig;
    model_.node_names = nodes_.names;
    model_.animation_names = animation_names(document_);
    model_.variant_names = variant_names(document_);
    std::vector<int> variants;
    for (const std::string& name : request_.variants)
      variants.push_back(find_name(document_.file(), "material variant", name, model_.variant_names));
    read_animations();
    GltfMeshes meshes(document_, materials_, &model_.materials, variants);
    for (size_t i = 0; i < nodes_.order.size(); ++i) read_node(static_cast<int>(i), meshes);
    return std::move(model_);
  }

 private:
  // Before the meshes: of those that are deformed more is kept.
  void read_animations() {
    for (const std::string& name : request_.animations) {
      const int index = find_name(document_.file(), "animation", name, model_.animation_names);
      model_.animations.push_back(read_animation(document_, nodes_, index));
      model_.animations.back().name = name;
      for (const GltfTrack& track : model_.animations.back().tracks)
        (track.path ? moves_ : morphs_)[static_cast<size_t>(track.node)] = true;
    }
    for (size_t n = 0; n < moves_.size(); ++n) {
      const int parent = nodes_.rig[n].parent;
      if (parent >= 0 && moves_[static_cast<size_t>(parent)]) moves_[n] = true;
    }
  }

  void read_node(int rig, GltfMeshes& meshes) {
    const JsonView place = document_.element("nodes", nodes_.order[static_cast<size_t>(rig)]);
    if (place.find("mesh")) read_object(place, rig, meshes);
    const int camera = place.index_or_none("camera", "cameras", document_.count("cameras"));
    if (camera >= 0) {
      model_.cameras.push_back(read_camera(document_.element("cameras", camera)));
      model_.cameras.back().name = nodes_.names[static_cast<size_t>(rig)];
      model_.cameras.back().node = rig;
    }
    if (const auto punctual = place.extension("KHR_lights_punctual")) read_node_light(*punctual, rig);
  }

  void read_node_light(const JsonView& punctual, int rig) {
    const auto lights = document_.root().extension("KHR_lights_punctual");
    if (!lights) punctual.fail("the file has no list of lights");
    const int64_t index = punctual.at("light").integer(0, INT32_MAX);
    Light light = read_light(lights->at("lights")[static_cast<size_t>(index)]);
    light.name = printable(nodes_.names[static_cast<size_t>(rig)]);
    light.node = rig;
    if (model_.lights.size() >= kMaxObjects) punctual.fail("the scene has more than 4096 lights", "reduce the model");
    model_.lights.push_back(light);
  }

  void read_object(const JsonView& place, int rig, GltfMeshes& meshes) {
    Object object;
    object.node = rig;
    MeshInstance instance;
    instance.mesh = place.index_or_none("mesh", "meshes", document_.count("meshes"));
    if (const auto weights = place.find("weights")) {
      instance.weights.resize(weights->size());
      weights->numbers(instance.weights, -1e6, 1e6);
    }
    const int skin = place.index_or_none("skin", "skins", document_.count("skins"));
    if (skin >= 0) {
      instance.skin = read_skin(document_, nodes_, skin);
      object.node = identity_node();
      // What the node's transform is left to say (glTF 2.0, section 3.7.4): on which side triangles have their fronts.
      const auto node = static_cast<size_t>(nodes_.order[static_cast<size_t>(rig)]);
      instance.mirrored = glm::determinant(glm::mat3(nodes_.world_at_rest[node])) < 0;
    }
    const std::vector<SkinJoint>& joints = instance.skin.joints;
    instance.joints_are_moved = std::any_of(joints.begin(), joints.end(), [&](const SkinJoint& joint) {
      return joint.node >= 0 && moves_[static_cast<size_t>(joint.node)];
    });
    instance.weights_are_driven = morphs_[static_cast<size_t>(rig)];
    if (!meshes.read(instance, object)) return;
    object.name = nodes_.names[static_cast<size_t>(rig)];
    if (object.name.empty()) object.name = document_.element("meshes", instance.mesh).text_or("name", "");
    if (model_.objects.size() >= kMaxObjects - 64) place.fail("the scene has more than 4032 meshes", "join some of them");
    model_.objects.push_back(std::move(object));
    model_.object_sources.push_back(rig);
  }

  // Skinned meshes stand in the scene's own space (glTF 2.0, section 3.7.3.3): one root for all of them.
  int identity_node() {
    if (identity_node_ < 0) {
      identity_node_ = static_cast<int>(model_.nodes.size());
      model_.nodes.emplace_back();
      model_.node_names.emplace_back();
    }
    return identity_node_;
  }

  const GltfRequest& request_;
  GltfModel model_;
  GltfDocument document_;
  GltfNodes nodes_;
  GltfMaterials materials_;
  std::vector<bool> moves_;   // per rig node: an animation moves it, or a node above it
  std::vector<bool> morphs_;  // per rig node: an animation drives the weights of its morph targets
  int identity_node_ = -1;
};

}  // namespace

GltfModel read_gltf(const GltfRequest& request) { return GltfReader(request).read(); }

}  // namespace vitrine
