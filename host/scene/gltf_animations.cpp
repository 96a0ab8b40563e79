// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/gltf_animations.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <set>

#include "host/scene/gltf_accessors.h"
#include "host/scene/gltf_meshes.h"
#include "host/scene/text.h"

namespace vitrine {
namespace {

std::optional<TrackPath> path_of(const std::string& path) {
  if (path == "translation") return TrackPath::kTranslation;
  if (path == "rotation") return TrackPath::kRotation;
  if (path == "scale") return TrackPath::kScale;
  return std::nullopt;
}

Interpolation interpolation_of(const JsonView& sampler) {
  const std::string text = sampler.text_or("interpolation", "LINEAR");
  if (text == "LINEAR") return Interpolation::kLinear;
  if (text == "STEP") return Interpolation::kStep;
  if (text == "CUBICSPLINE") return Interpolation::kCubicSpline;
  sampler.at("interpolation").fail(in_quotes(text) + " is not LINEAR, STEP or CUBICSPLINE");
}

void check_times(const JsonView& input, const std::vector<float>& times) {
  if (times.front() < 0) input.fail("key times must not be negative");
  for (size_t k = 1; k < times.size(); ++k)
    if (!(times[k] > times[k - 1])) input.fail(fmt::format("key times must ascend, but key {} does not", k));
}

// The values of rotation keys (not their tangents) to unit length.
void normalize_rotations(const JsonView& output, GltfTrack& track) {
  const bool cubic = track.interpolation == Interpolation::kCubicSpline;
  for (size_t k = 0; k < track.times.size(); ++k) {
    float* q = &track.values[cubic ? 12 * k + 4 : 4 * k];
    const glm::quat value(q[3], q[0], q[1], q[2]);
    if (glm::length(value) < 1e-3f) output.fail(fmt::format("key {} is not a rotation: the quaternion has no length", k));
    const glm::quat unit = glm::normalize(value);
    q[0] = unit.x;
    q[1] = unit.y;
    q[2] = unit.z;
    q[3] = unit.w;
  }
}

// Floats per value of a channel.
size_t components_of(GltfDocument& document, const JsonView& channel, int node, std::optional<TrackPath> path) {
  if (path) return path == TrackPath::kRotation ? 4 : 3;
  const int mesh = document.element("nodes", node).index_or_none("mesh", "meshes", document.count("meshes"));
  const size_t targets = mesh < 0 ? 0 : morph_target_count(document.element("meshes", mesh));
  if (targets == 0) channel.fail(fmt::format("moves morph weights of node {}, which has no morph targets", node));
  return targets;
}

GltfTrack read_sampler(GltfDocument& document, const JsonView& sampler, std::optional<TrackPath> path, size_t components) {
  GltfTrack track;
  track.path = path;
  track.components = components;
  track.interpolation = interpolation_of(sampler);
  const JsonView input = sampler.at("input"), output = sampler.at("output");
  track.times = read_floats(document, input, 1);
  check_times(input, track.times);
  const size_t per_value = path ? components : 1;  // weights are listed one by one
  track.values = read_floats(document, output, static_cast<int>(per_value));
  const size_t needed = track.times.size() * components * (track.interpolation == Interpolation::kCubicSpline ? 3 : 1);
  if (track.values.size() != needed)
    output.fail(fmt::format("has {} {}, but its {} keys need {}", track.values.size() / per_value, path ? "values" : "weights",
                            track.times.size(), needed / per_value));
  if (path == TrackPath::kRotation) normalize_rotations(output, track);
  return track;
}

}  // namespace

std::vector<std::string> animation_names(const GltfDocument& document) {
  std::vector<std::string> names;
  for (size_t a = 0; a < document.count("animations"); ++a)
    names.push_back(document.element("animations", static_cast<int>(a)).text_or("name", fmt::format("animation {}", a)));
  return names;
}

GltfAnimation read_animation(GltfDocument& document, const GltfNodes& nodes, int animation) {
  const JsonView place = document.element("animations", animation);
  const JsonView channels = place.at("channels"), samplers = place.at("samplers");
  GltfAnimation result;
  std::set<std::pair<int, std::optional<TrackPath>>> targets;
  for (size_t c = 0; c < channels.size(); ++c) {
    const JsonView target = channels[c].at("target");
    const int node = target.index_or_none("node", "nodes", nodes.size());
    const std::optional<TrackPath> path = path_of(target.at("path").text());
    const bool weights = target.at("path").text() == "weights";
    if ((!path && !weights) || node < 0) {
      document.warn(channels[c].where() + " moves no node that is known and is not followed");
      continue;
    }
    if (!targets.insert({node, *path}).second)
      channels[c].fail(fmt::format("moves node {} a second time on the same path", node));
    if (path && document.element("nodes", node).find("matrix"))
      channels[c].fail(fmt::format("moves node {}, which has a matrix", node));
    const int sampler = channels[c].index_or_none("sampler", "samplers", samplers.size());
    if (sampler < 0) channels[c].fail("names no sampler");
    const size_t components = components_of(document, channels[c], node, path);
    GltfTrack track = read_sampler(document, samplers[static_cast<size_t>(sampler)], path, components);
    result.duration = std::max(result.duration, track.times.back());
    track.node = nodes.rig_of[static_cast<size_t>(node)];
    if (track.node >= 0) result.tracks.push_back(std::move(track));
  }
  if (result.tracks.empty()) place.fail("moves no node of the scene", "name another animation");
  return result;
}

}  // namespace vitrine
