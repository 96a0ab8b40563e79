// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// scene.toml as a structure: syntax, keys, types and ranges are checked here; whether names exist in the model, later.
//
// Keys (all lengths in metres, all angles in degrees):
//   scene                "model.glb" or "model.gltf", relative to the .toml                                    required
//   environment          "map.exr", "map.hdr" (lat-long or cube map) or a constant radiance [r, g, b]          none
//   environment_rotation degrees about +Y                                                                      0
//   background           "environment", or a colour [r, g, b] that is seen but lights nothing                  "environment"
//   resolution           [width, height]                                                                       [640, 480]
//   samples_per_pixel    camera rays of a pixel; of compiled frames: in the mean, at most                      64
//   noise                decibels between two renderings that compiled frames are traced to, in every layer    45
//   max_radiance         bound of one path's indirect light; 0: none                                           0
//   caustics             true: light is refracted on its way to what it lights: focused, and noisy;            false
//                        false: it goes straight through glass and casts plain bright shadows
//   camera               name of a camera's node                                                               the first
//   exposure             factor between radiance and the screen                                                1
//   [[axis]] name, samples, kind ("linear", "periodic", "discrete"), max_speed, names = [...], and one of
//     animation = "NAME"                                        a glTF animation, from 0 to its last key
//     orbit = { target, radius, height, from, to, yfov }        a camera around a vertical axis; height is above target
//     variants = ["a", "b"]                                     material variants (discrete)
//     lights = [["node"], ["node", "node"], []]                 which emitters shine at each value (discrete)
//     lamp = { target, radius, elevation, from, to, size, color, strength }   a luminous ball that travels on an arc
//   [[object]] node, representation ("texture"), resolution_scale, weight
//   [target] profile, storage, codec ("dct", "spiht"), interpolate, between, smoothing, worst_object, exposure
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/scene/scene.h"

namespace vitrine {

inline constexpr int kMostSamples = 4096;             // of an axis
inline constexpr int64_t kMostGridSamples = 1 << 20;  // of the grid
inline constexpr int kMostValues = 64;                // of a discrete axis

struct OrbitDescription {
  glm::vec3 target{0};
  float radius = 3, height = 1;  // horizontal distance; height above the target
  float from = 0, to = 360;      // degrees; 0 stands on +Z of the target, 90 on +X
  std::optional<float> yfov;     // degrees; else the model's first camera's, else 40
};

struct LampDescription {
  glm::vec3 target{0};
  float radius = 2, elevation = 60;  // distance from the target, angle above the horizon
  float from = -60, to = 60;         // degrees of azimuth, as an orbit's
  float size = 0.2f;                 // diameter
  glm::vec3 color{1};
  float strength = 50;  // radiance is color times strength
};

struct AxisDescription {
  std::string place;  // for messages: "scene.toml: axis \"view\""
  std::string name;
  AxisKind kind = AxisKind::kLinear;
  int samples = 0;
  float max_speed = 0.25f;
  std::vector<std::string> names;
  // Exactly one of these drives something.
  std::string animation;
  std::optional<OrbitDescription> orbit;
  std::vector<std::string> variants;
  std::optional<std::vector<std::vector<std::string>>> lights;
  std::optional<LampDescription> lamp;
};

struct ObjectDescription {
  std::string place, node;
  std::string representation = "texture";
  float resolution_scale = 1, weight = 1;
};

struct SceneDescription {
  std::filesystem::path file, folder, model;
  std::optional<std::filesystem::path> environment_file;
  std::optional<glm::vec3> environment_color;
  float environment_rotation = 0;             // radians
  std::optional<glm::vec3> background_color;  // else the environment itself
  std::string camera;
  Settings settings;
  std::vector<AxisDescription> axes;
  std::vector<ObjectDescription> objects;
};

// `scene` is a folder that holds scene.toml, or a .toml file. Throws InputError.
SceneDescription read_scene_description(const std::filesystem::path& scene);

}  // namespace vitrine
