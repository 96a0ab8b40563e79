// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// scene.toml, model and environment, put together.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <set>

#include "host/base/error.h"
#include "host/scene/axes.h"
#include "host/scene/environment.h"
#include "host/scene/files.h"
#include "host/scene/framing.h"
#include "host/scene/gltf.h"
#include "host/scene/scene.h"
#include "host/scene/scene_toml.h"
#include "host/scene/text.h"

namespace vitrine {
namespace {

constexpr float kDefaultYfov = 0.698132f;  // 40 degrees

GltfModel read_model(const SceneDescription& description) {
  GltfRequest request;
  request.model = description.model;
  request.root = description.folder;
  for (const AxisDescription& axis : description.axes) {
    if (!axis.animation.empty()) request.animations.push_back(axis.animation);
    if (!axis.variants.empty()) request.variants = axis.variants;
  }
  return read_gltf(request);
}

std::string scene_name(const SceneDescription& description) {
  const std::filesystem::path file = std::filesystem::absolute(description.file);
  const bool folder = file.filename() == "scene.toml" && file.has_parent_path();
  return printable((folder ? file.parent_path().filename() : file.stem()).string());
}

class SceneLoader {
 public:
  explicit SceneLoader(const std::filesystem::path& path)
      : description_(read_scene_description(path)), place_(shown(description_.file)) {}

  std::unique_ptr<Scene> load() {
    scene_->name = scene_name(description_);
    scene_->file = description_.file;
    scene_->settings = description_.settings;
    take_model();
    take_environment();
    const OrbitCamera orbit = apply_axes(description_, model_, *scene_, node_names_);
    name_objects();
    place_camera(orbit);
    fit_depth(*scene_);
    if (has_backdrop()) add_backdrop(*scene_);
    make_names_unique();
    apply_object_entries();
    return std::move(scene_);
  }

 private:
  void take_model() {
    model_ = read_model(description_);
    scene_->nodes = model_.nodes;
    scene_->materials = std::move(model_.materials);
    scene_->images = std::move(model_.images);
    scene_->objects = std::move(model_.objects);
    scene_->lights = std::move(model_.lights);
    scene_->warnings = model_.warnings;
    node_names_ = model_.node_names;
    if (scene_->objects.empty())
      throw InputError(shown(description_.model), "there is nothing to see in it", "give a model with triangles in its scene");
  }

  void take_environment() {
    if (description_.environment_file) scene_->environment = read_environment(*description_.environment_file, &scene_->warnings);
    if (description_.environment_color) scene_->environment = constant_environment(*description_.environment_color);
    scene_->environment.rotation = description_.environment_rotation;
    scene_->background_is_environment = !description_.background_color.has_value();
    scene_->background_color = description_.background_color.value_or(glm::vec3(0));
  }

  bool has_backdrop() const { return description_.background_color || scene_->environment.width > 0; }

  void apply_object_entries() {
    for (const ObjectDescription& entry : description_.objects) {
      bool found = false;
      for (size_t o = 0; o < scene_->objects.size(); ++o) {
        if (node_name_of(o) != entry.node && scene_->objects[o].name != entry.node) continue;
        scene_->objects[o].representation = entry.representation;
        scene_->objects[o].resolution_scale = entry.resolution_scale;
        scene_->objects[o].weight = entry.weight;
        found = true;
      }
      if (!found) fail_unknown_object(entry);
    }
  }

  std::string node_name_of(size_t object) const {
    const int node = object < model_.object_sources.size() ? model_.object_sources[object] : scene_->objects[object].node;
    return static_cast<size_t>(node) < node_names_.size() ? node_names_[static_cast<size_t>(node)] : "";
  }

  [[noreturn]] void fail_unknown_object(const ObjectDescription& entry) const {
    std::vector<std::string> names;
    for (const Object& object : scene_->objects) names.push_back(object.name);
    throw InputError(entry.place, "there is no object " + in_quotes(entry.node),
                     "did you mean " + in_quotes(nearest_word(entry.node, names)) + "? There are " + joined(names));
  }

  void name_objects() {
    for (size_t o = 0; o < scene_->objects.size(); ++o)
      scene_->objects[o].name =
          printable(scene_->objects[o].name.empty() ? fmt::format("object-{}", o) : scene_->objects[o].name, 64);
  }

  void make_names_unique() {
    std::set<std::string> taken;
    if (scene_->background_object >= 0) taken.insert(scene_->objects.back().name);
    for (Object& object : scene_->objects) {
      if (object.follows_camera || taken.insert(object.name).second) continue;
      std::string name;
      for (int n = 2; name.empty() || !taken.insert(name).second; ++n) name = fmt::format("{}-{}", object.name, n);
      object.name = name;
    }
  }

  void place_camera(const OrbitCamera& orbit) {
    Camera& camera = scene_->camera;
    camera.yfov = kDefaultYfov;
    if (const GltfCamera* given = chosen_camera()) {
      camera.perspective = given->perspective;
      camera.yfov = given->perspective ? given->yfov : kDefaultYfov;
      camera.ymag = given->ymag;
      camera.node = without_scale(given->node);
    }
    if (orbit.node >= 0) {
      camera.node = orbit.node;
      if (orbit.yfov > 0) {
        camera.yfov = orbit.yfov;
        camera.perspective = true;
      }
    } else if (model_.cameras.empty()) {
      camera.node = add_fitted_camera(*scene_, bounds_of(*scene_));
      scene_->warnings.push_back(place_ + ": the model has no camera and no axis orbits; the view is fitted to the model");
    }
  }

  const GltfCamera* chosen_camera() const {
    if (description_.camera.empty()) return model_.cameras.empty() ? nullptr : &model_.cameras.front();
    std::vector<std::string> names;
    for (const GltfCamera& camera : model_.cameras) {
      if (camera.name == description_.camera) return &camera;
      names.push_back(camera.name);
    }
    const std::string remedy = names.empty() ? "the model has none" : "there are " + joined(names);
    throw InputError(place_, "there is no camera " + in_quotes(description_.camera), remedy);
  }

  // A camera is rigid: where its node is scaled, it hangs on a node that undoes this.
  int without_scale(int node) {
    std::vector<glm::mat4> world(scene_->nodes.size());
    evaluate_rig(scene_->rig(), Position{}, world);
    const glm::mat4& m = world[static_cast<size_t>(node)];
    const glm::vec3 x(m[0]), y(m[1]), z(m[2]);
    const float sx = glm::length(x), sy = glm::length(y), sz = glm::length(z), s = std::cbrt(sx * sy * sz);
    const bool similar = s > 1e-12f && std::max({sx, sy, sz}) < 1.01f * std::min({sx, sy, sz}) &&
                         glm::determinant(glm::mat3(m)) > 0 &&
                         std::abs(glm::dot(x, y)) + std::abs(glm::dot(y, z)) + std::abs(glm::dot(z, x)) < 0.01f * s * s;
    if (!similar)
      throw InputError(shown(description_.model), "the camera's node is stretched or mirrored",
                       "put the camera below nodes without scale");
    if (std::abs(s - 1) < 1e-5f) return node;
    RigNode undo;
    undo.parent = node;
    undo.scale = glm::vec3(1 / s);
    scene_->nodes.push_back(undo);
    node_names_.emplace_back();
    return static_cast<int>(scene_->nodes.size()) - 1;
  }

  SceneDescription description_;
  std::string place_;
  GltfModel model_;
  std::vector<std::string> node_names_;
  std::unique_ptr<Scene> scene_ = std::make_unique<Scene>();
};

}  // namespace

std::unique_ptr<Scene> load_scene(const std::filesystem::path& scene) { return SceneLoader(scene).load(); }

}  // namespace vitrine
