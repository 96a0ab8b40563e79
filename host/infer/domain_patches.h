// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Where to cut the texture domain of an object into patches (formats/texture_map.h). An affine map can but crop a rectangle out
// of the domain, and lay it down as fine everywhere. A vessel shows the front of its outer wall and the back of its inner one,
// which lie on opposite sides of a domain; a floor shows much of its near end and little of its far one. So the domain is cut, by
// lines along u or v, wherever the patches need clearly fewer texels by themselves, gutters included.
#pragma once

#include <span>
#include <vector>

#include "host/infer/inference.h"
#include "host/infer/visible_surface.h"

namespace vitrine {

// What some textures show, each counting as much as its weight.
struct WeightedSurface {
  VisibleSurface surface;
  double weight = 1;
};
// At most kMaxPatches, which tile the domain; one where cuts do not pay. `regions`: visible.
std::vector<DomainPart> choose_patches(std::span<const WeightedSurface> regions, const TextureFitOptions& options);

}  // namespace vitrine
