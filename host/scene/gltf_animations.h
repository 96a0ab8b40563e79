// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Animations (glTF 2.0, section 3.11).
#pragma once

#include <string>
#include <vector>

#include "host/scene/gltf.h"
#include "host/scene/gltf_nodes.h"

namespace vitrine {

GltfAnimation read_animation(GltfDocument& document, const GltfNodes& nodes, int animation);
// Names of all animations, "animation N" (N from 0) where the file gives none.
std::vector<std::string> animation_names(const GltfDocument& document);

}  // namespace vitrine
