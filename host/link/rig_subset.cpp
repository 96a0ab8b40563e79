// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/link/rig_subset.h"

namespace vitrine {

RigSubset select_rig(const Scene& scene, const std::vector<int>& carriers) {
  std::vector<bool> needed(scene.nodes.size(), false);
  for (int node : carriers)
    for (; node >= 0 && !needed[static_cast<size_t>(node)]; node = scene.nodes[static_cast<size_t>(node)].parent)
      needed[static_cast<size_t>(node)] = true;
  RigSubset subset;
  subset.new_number.assign(scene.nodes.size(), -1);
  for (uint32_t node = 0; node < scene.nodes.size(); ++node) {
    if (!needed[node]) continue;
    subset.new_number[node] = static_cast<int32_t>(subset.nodes.size());
    subset.nodes.push_back(node);
  }
  for (uint32_t track = 0; track < scene.tracks.size(); ++track)
    if (needed[scene.tracks[track].node]) subset.tracks.push_back(track);
  return subset;
}

}  // namespace vitrine
