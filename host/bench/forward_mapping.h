// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Textures by forward mapping (Hakura 2001, section 3.3): every texel of the texture domain is mapped to the picture and takes
// there what a separable Lanczos-windowed sinc of half-width 4 pixels makes of the object's layer. How the target filters
// textures plays no part: a peer of texture inference.
#pragma once

#include <glm/mat4x4.hpp>

#include "host/bench/filling.h"
#include "host/infer/inference.h"
#include "host/infer/verification.h"
#include "host/trace/frame.h"

namespace vitrine {

// All layers of an object together over the whole picture, each cut at `white` as inference cuts them. Undefined where it covers
// less than half of a pixel.
PartialPicture object_layers(const Frame& frame, int object, float white);

// A texture that lies as `placement` says. `layers` is filled by reflection first, beyond the picture's edge too; texels that no
// triangle covers are filled from their neighbours.
LinearTexture map_forward(const DrawnObject& object, const Placement& placement, const glm::mat4& clip_from_object,
                          const PartialPicture& layers);

}  // namespace vitrine
