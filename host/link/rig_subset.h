// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The part of a scene's rig that a picture needs: the nodes that carry the camera and the drawn objects, and all above them.
#pragma once

#include <cstdint>
#include <vector>

#include "host/scene/scene.h"

namespace vitrine {

struct RigSubset {
  std::vector<uint32_t> nodes;      // scene node of each kept node, ascending (so parents still stand first)
  std::vector<int32_t> new_number;  // per scene node: its place in `nodes`, or -1
  std::vector<uint32_t> tracks;     // scene tracks that move a kept node, ascending
};

// `carriers`: scene nodes that must be there.
RigSubset select_rig(const Scene& scene, const std::vector<int>& carriers);

}  // namespace vitrine
