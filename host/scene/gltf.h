// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Reads a glTF 2.0 model into the scene's terms. Animations are returned in seconds; what drives them is the business of
// the scene file (axes.h).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/scene/files.h"
#include "host/scene/scene.h"

namespace vitrine {

// A camera of the file, hung on a rig node.
struct GltfCamera {
  std::string name;  // of the node
  int node = 0;
  bool perspective = true;
  float yfov = 0.7f, ymag = 1;  // radians; half height in metres
};

// One animated property. Times ascend strictly and are not negative; values as RigTrack::values, tangents per second.
struct GltfTrack {
  int node = 0;                   // rig node
  std::optional<TrackPath> path;  // none: the weights of the node's morph targets
  size_t components = 3;          // floats per value: 3, 4 (rotations) or the number of morph targets
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<float> times, values;
};

struct GltfAnimation {
  std::string name;
  std::vector<GltfTrack> tracks;
  float duration = 0;  // seconds: the last key of all tracks
};

// What the scene file wants of a model.
struct GltfRequest {
  std::filesystem::path model;
  std::filesystem::path root;           // companions must lie below it; empty: the model's own folder
  std::vector<std::string> variants;    // names of material variants, one per value of the variants axis
  std::vector<std::string> animations;  // names
  const Bytes* bytes = nullptr;         // the model's file, where it is in memory; `model` then only names it
};

struct GltfModel {
  std::vector<RigNode> nodes;           // those of the model's scene, parents first
  std::vector<std::string> node_names;  // parallel; may be empty or repeat
  std::vector<Material> materials;
  std::vector<Image> images;
  std::vector<Object> objects;      // names not yet unique
  std::vector<int> object_sources;  // parallel: the rig node whose mesh it is (Object::node differs for skins)
  std::vector<Light> lights;
  std::vector<GltfCamera> cameras;
  std::vector<GltfAnimation> animations;                    // parallel to the request
  std::vector<std::string> animation_names, variant_names;  // all that the file has
  std::vector<std::string> warnings;
};

// Throws InputError, on one line, for anything that is wrong, missing or too large.
GltfModel read_gltf(const GltfRequest& request);

}  // namespace vitrine
