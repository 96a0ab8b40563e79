// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What the inferred textures show before any coding: the loss of inference alone.
#pragma once

#include "hal/gpu.h"
#include "host/infer/inference.h"
#include "host/verify/verify.h"

namespace vitrine {

// Draws the nearest sample's uncoded textures (half floats, as the target would hold them) from `position`.
Picture draw_inferred(const Scene& scene, const Inference& inference, const Store& store, hal::Gpu& gpu, const Position& position,
                      int supersampling);

}  // namespace vitrine
