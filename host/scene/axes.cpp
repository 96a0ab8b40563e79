// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "host/base/error.h"
#include "host/scene/shapes.h"
#include "host/scene/text.h"

namespace vitrine {
namespace {

constexpr float kRadiansPerDegree = std::numbers::pi_v<float> / 180;

constexpr size_t kMostSwitched = 4096;  // names in an axis of lights

// Per node, whether it or an ancestor is one of those marked (nodes stand parents first).
void spread_to_children(const std::vector<RigNode>& nodes, std::vector<bool>& marked) {
  for (size_t n = 0; n < nodes.size(); ++n)
    if (nodes[n].parent >= 0 && marked[static_cast<size_t>(nodes[n].parent)]) marked[n] = true;
}

bool emits(const Scene& scene, const Object& object) {
  const auto shines = [&](int m) { return scene.materials[static_cast<size_t>(m)].emissive != glm::vec3(0); };
  if (std::any_of(object.geometry.triangle_materials.begin(), object.geometry.triangle_materials.end(), shines)) return true;
  return std::any_of(object.variant_materials.begin(), object.variant_materials.end(),
                     [&](const std::vector<int>& row) { return std::any_of(row.begin(), row.end(), shines); });
}

class AxisBuilder {
 public:
  AxisBuilder(const SceneDescription& description, const GltfModel& model, Scene& scene, std::vector<std::string>& node_names)
      : description_(description), model_(model), scene_(scene), names_(node_names) {}

  OrbitCamera build() {
    for (const AxisDescription& axis : description_.axes) add(axis);
    return orbit_;
  }

 private:
  void add(const AxisDescription& description) {
    axis_ = static_cast<int>(scene_.axes.size());
    Axis axis;
    axis.name = description.name;
    axis.shape = {description.kind, description.samples};
    axis.max_speed = description.max_speed;
    axis.value_names = description.names;
    scene_.axes.push_back(axis);
    if (!description.animation.empty()) add_animation(description);
    if (description.orbit) add_orbit(description, *description.orbit);
    if (!description.variants.empty()) add_variants(description);
    if (description.lights) add_lights(description, *description.lights);
    if (description.lamp) add_lamp(description, *description.lamp);
    name_values(description);
  }

  void name_values(const AxisDescription& description) {
    std::vector<std::string>& names = scene_.axes.back().value_names;
    if (description.kind != AxisKind::kDiscrete || !names.empty()) return;
    for (int v = 0; v < description.samples; ++v) names.push_back(fmt::format("{}", v));
  }

  void add_track(const AxisDescription& description, int node, TrackPath path, Interpolation interpolation,
                 std::vector<float> positions, std::vector<float> values) {
    if (!moved_.insert({node, path}).second)
      throw InputError(
          description.place,
          "it moves node " + in_quotes(names_[static_cast<size_t>(node)]) + " on a path that another axis moves already",
          "let one axis drive it, or put a parent node in between");
    RigTrack track;
    track.node = static_cast<uint32_t>(node);
    track.axis = static_cast<uint32_t>(axis_);
    track.path = path;
    track.interpolation = interpolation;
    scene_.tracks.push_back(track);
    scene_.track_data.push_back(std::move(positions));
    scene_.track_data.push_back(std::move(values));
  }

  void add_weight_track(const AxisDescription& description, const GltfTrack& track, std::vector<float> positions,
                        std::vector<float> values) {
    const auto source = std::find(model_.object_sources.begin(), model_.object_sources.end(), track.node);
    if (source == model_.object_sources.end()) return;  // its mesh has nothing to show
    const int object = static_cast<int>(source - model_.object_sources.begin());
    for (const WeightTrack& other : scene_.weight_tracks)
      if (other.object == object)
        throw InputError(description.place,
                         "it drives the morph targets of " + in_quotes(names_[static_cast<size_t>(track.node)]) +
                             ", which another axis drives already",
                         "let one axis drive them");
    scene_.weight_tracks.push_back({object, axis_, track.interpolation, std::move(positions), std::move(values)});
  }

  // [0, 1] of the axis is [0, last key] of the animation.
  void add_animation(const AxisDescription& description) {
    const GltfAnimation& animation = model_.animations[static_cast<size_t>(next_animation_++)];
    for (const GltfTrack& track : animation.tracks) {
      std::vector<float> positions = track.times, values = track.values;
      for (float& p : positions) p = animation.duration > 0 ? std::min(1.0f, p / animation.duration) : 0.0f;
      for (size_t k = 1; k < positions.size(); ++k)
        if (!(positions[k] > positions[k - 1]))
          throw InputError(description.place, "two keys of its animation fall together",
                           "remove keys that are closer than float can tell");
      if (track.interpolation == Interpolation::kCubicSpline) scale_tangents(track, animation.duration, values);
      if (track.path)
        add_track(description, track.node, *track.path, track.interpolation, std::move(positions), std::move(values));
      else
        add_weight_track(description, track, std::move(positions), std::move(values));
    }
  }

  static void scale_tangents(const GltfTrack& track, float duration, std::vector<float>& values) {
    const size_t n = track.components;
    for (size_t k = 0; k < track.times.size(); ++k)
      for (size_t c = 0; c < n; ++c) {
        values[3 * n * k + c] *= duration;
        values[3 * n * k + 2 * n + c] *= duration;
      }
  }

  int add_node(const RigNode& node, const std::string& name) {
    scene_.nodes.push_back(node);
    names_.push_back(name);
    return static_cast<int>(scene_.nodes.size()) - 1;
  }

  // A node at `target` that turns about +Y; keys at most a quarter turn apart, so that the shortest way is the one meant.
  int add_turning_node(const AxisDescription& description, const glm::vec3& target, float from, float to) {
    RigNode pivot;
    pivot.translation = target;
    pivot.rotation = rotation_about_y(from);
    const int node = add_node(pivot, description.name + " pivot");
    const int spans = std::max(1, static_cast<int>(std::ceil(std::abs(to - from) / 90)));
    std::vector<float> positions, values;
    for (int k = 0; k <= spans; ++k) {
      const float p = static_cast<float>(k) / static_cast<float>(spans);
      const glm::quat q = rotation_about_y(from + (to - from) * p);
      positions.push_back(p);
      values.insert(values.end(), {q.x, q.y, q.z, q.w});
    }
    add_track(description, node, TrackPath::kRotation, Interpolation::kLinear, std::move(positions), std::move(values));
    const float turns = std::abs(to - from) / 360;
    if (description.kind == AxisKind::kPeriodic && std::abs(turns - std::round(turns)) > 1e-4f)
      scene_.warnings.push_back(description.place + ": a periodic axis should turn by a multiple of 360 degrees");
    return node;
  }

  void add_orbit(const AxisDescription& description, const OrbitDescription& orbit) {
    if (orbit_.node >= 0)
      throw InputError(description.place, "there is an orbit already", "a scene has one camera; leave one orbit");
    RigNode camera;
    camera.parent = add_turning_node(description, orbit.target, orbit.from, orbit.to);
    camera.translation = {0, orbit.height, orbit.radius};
    camera.rotation = glm::angleAxis(-std::atan2(orbit.height, orbit.radius), glm::vec3(1, 0, 0));
    orbit_.node = add_node(camera, description.name + " camera");
    orbit_.yfov = orbit.yfov.value_or(0.0f) * kRadiansPerDegree;
  }

  void add_variants(const AxisDescription& description) {
    if (scene_.variant_axis >= 0)
      throw InputError(description.place, "there is an axis of variants already", "leave one of them");
    scene_.variant_axis = axis_;
    if (scene_.axes.back().value_names.empty()) scene_.axes.back().value_names = description.variants;
  }

  void add_lights(const AxisDescription& description, const std::vector<std::vector<std::string>>& values) {
    std::set<std::string> all;
    for (const auto& value : values) all.insert(value.begin(), value.end());
    if (all.size() > kMostSwitched) throw InputError(description.place, "it names very many nodes", "name a node above them");
    for (const std::string& name : all) {
      std::vector<float> factors;
      for (const auto& value : values)
        factors.push_back(std::find(value.begin(), value.end(), name) != value.end() ? 1.0f : 0.0f);
      switch_node(description, name, factors);
    }
    std::vector<std::string>& names = scene_.axes.back().value_names;
    if (!names.empty()) return;
    for (const auto& value : values) names.push_back(value.empty() ? "off" : joined(value, 4));
  }

  // Everything that emits at or below the nodes of this name.
  void switch_node(const AxisDescription& description, const std::string& name, const std::vector<float>& factors) {
    std::vector<bool> under = nodes_named(description.place, name);
    spread_to_children(scene_.nodes, under);
    int found = 0;
    const auto bind = [&](auto& emitter) {
      if (emitter.emission_axis >= 0)
        throw InputError(description.place, in_quotes(emitter.name) + " is switched twice", "name it, or a node above it, once");
      emitter.emission_axis = axis_;
      emitter.emission_of_value = factors;
      ++found;
    };
    for (size_t o = 0; o < scene_.objects.size(); ++o) {
      const int source = o < model_.object_sources.size() ? model_.object_sources[o] : scene_.objects[o].node;
      if (under[static_cast<size_t>(source)] && emits(scene_, scene_.objects[o])) bind(scene_.objects[o]);
    }
    for (Light& light : scene_.lights)
      if (under[static_cast<size_t>(light.node)]) bind(light);
    if (found == 0)
      throw InputError(description.place, "the node " + in_quotes(name) + " emits nothing",
                       "name nodes with an emissive material or a light");
  }

  std::vector<bool> nodes_named(const std::string& place, const std::string& name) const {
    std::vector<bool> marked(names_.size());
    for (size_t n = 0; n < names_.size(); ++n) marked[n] = names_[n] == name;
    if (std::find(marked.begin(), marked.end(), true) == marked.end())
      throw InputError(place, "there is no node " + in_quotes(name),
                       "did you mean " + in_quotes(nearest_word(name, names_)) + "?");
    return marked;
  }

  void add_lamp(const AxisDescription& description, const LampDescription& lamp) {
    RigNode carrier;
    carrier.parent = add_turning_node(description, lamp.target, lamp.from, lamp.to);
    const float elevation = lamp.elevation * kRadiansPerDegree;
    carrier.translation = lamp.radius * glm::vec3(0, std::sin(elevation), std::cos(elevation));
    Material material;
    material.name = description.name;
    material.base_color = {0, 0, 0, 1};
    material.roughness = 1;
    material.metallic = 0;
    material.specular = 0;
    material.emissive = lamp.color * lamp.strength;
    Object object;
    object.name = description.name;
    object.node = add_node(carrier, description.name);
    object.geometry = make_sphere(lamp.size / 2, 24, 12);
    object.geometry.triangle_materials.assign(object.geometry.indices.size() / 3, static_cast<int>(scene_.materials.size()));
    scene_.materials.push_back(material);
    scene_.objects.push_back(std::move(object));
  }

  const SceneDescription& description_;
  const GltfModel& model_;
  Scene& scene_;
  std::vector<std::string>& names_;
  OrbitCamera orbit_;
  std::set<std::pair<int, TrackPath>> moved_;
  int axis_ = 0;
  int next_animation_ = 0;
};

}  // namespace

glm::quat rotation_about_y(float degrees) { return glm::angleAxis(degrees * kRadiansPerDegree, glm::vec3(0, 1, 0)); }

OrbitCamera apply_axes(const SceneDescription& description, const GltfModel& model, Scene& scene,
                       std::vector<std::string>& node_names) {
  const OrbitCamera orbit = AxisBuilder(description, model, scene, node_names).build();
  for (size_t t = 0; t < scene.tracks.size(); ++t) {  // only now: the vectors no longer move
    scene.tracks[t].positions = scene.track_data[2 * t];
    scene.tracks[t].values = scene.track_data[2 * t + 1];
  }
  return orbit;
}

}  // namespace vitrine
