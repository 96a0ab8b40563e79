// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How a fragment reads its textures (formulas: formats/SPEC.md, "Drawing"). An image names the one with which its textures were
// inferred.
#pragma once

#include <cstdint>

namespace vitrine {

enum class SurfaceFilter : uint8_t {
  kBilinear,      // of the finest level alone
  kTrilinear,     // at the level that the device chooses
  kAnisotropic2,  // 2 taps, each trilinear at a level that is finer by up to 1 where the footprint is long
  kAnisotropic4,  // 4 taps, finer by up to 2
};

}  // namespace vitrine
