// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What the frames hold, layer by layer: which layers carry light at all, and which are constant.
#pragma once

#include <array>
#include <vector>

#include "host/frames/store.h"
#include "host/infer/fields.h"
#include "host/scene/scene.h"

namespace vitrine {

struct LayerLight {
  float lit_share = 0;      // greatest share, over frames, of the object's pixels that show more than one code of 8-bit sRGB
  float low = 0, high = 0;  // of any channel over all pixels at least half covered, all frames
};
using ObjectLight = std::array<LayerLight, 2>;  // by Layer

// Per scene object. Read once from all frames, then kept in the store. Throws InputError where a frame is missing.
std::vector<ObjectLight> survey_light(const Scene& scene, const std::vector<StoreKey>& frames, const Store& store);

bool carries_light(const LayerLight& light);  // in some frame at least one pixel in a thousand is lit
bool is_constant(const LayerLight& light);    // to a thousandth

// The frame under `key`. Throws InputError where the store has it no more.
Frame load_frame_or_throw(const Store& store, const StoreKey& key, const Scene& scene);

}  // namespace vitrine
