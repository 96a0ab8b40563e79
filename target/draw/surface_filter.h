// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How a fragment reads its texture: at one or more places ("taps") along its footprint, whose mean it takes. Devices agree on
// bilinear and trilinear fetches, but follow no common formula in their own anisotropic filters, so the anisotropic ones here
// are explicit taps, after the formulas of EXT_texture_filter_anisotropic.
#pragma once

#include "formats/surface_filter.h"

namespace vitrine {

int tap_count(SurfaceFilter filter);

// For fragment shaders (GLSL ES 3.00), the same for all that read surfaces:
//   const int surface_taps
//   vec4 surface_tap(sampler2D texels, vec2 uv, int tap, out vec2 at)
// what tap number `tap` of the fragment at texture coordinates `uv` reads, and where.
const char* surface_tap_source(SurfaceFilter filter);

}  // namespace vitrine
