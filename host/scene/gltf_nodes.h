// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The node hierarchy (glTF 2.0, section 3.5): which nodes the scene holds, in which order, and where they are at rest.
#pragma once

#include <string>
#include <vector>

#include "host/scene/deformation.h"
#include "host/scene/gltf_document.h"
#include "host/scene/scene.h"

namespace vitrine {

struct GltfNodes {
  std::vector<int> parent;               // per glTF node; -1 for roots
  std::vector<int> order;                // the scene's glTF nodes, parents first, in the file's order
  std::vector<int> rig_of;               // rig node of a glTF node, -1 outside the scene
  std::vector<RigNode> rig;              // parallel to order
  std::vector<std::string> names;        // parallel to order
  std::vector<glm::mat4> world_at_rest;  // per glTF node, in the scene or not

  size_t size() const { return parent.size(); }
};

// Fails on nodes with two parents, on cycles and on transforms that are no transforms.
GltfNodes read_nodes(GltfDocument& document);

// A skin (glTF 2.0, section 3.7.3). Joints outside the scene stand still.
struct GltfSkin {
  std::vector<SkinJoint> joints;
  std::vector<glm::mat4> world_from_bind;  // per joint, at rest
};
GltfSkin read_skin(GltfDocument& document, const GltfNodes& nodes, int skin);

}  // namespace vitrine
