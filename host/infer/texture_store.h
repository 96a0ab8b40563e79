// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Inferred textures in the store: planes R, G, B of linear radiance, row 0 is v = 0, and `precision` (host/infer/solver.h).
#pragma once

#include "host/frames/store.h"
#include "host/infer/axis_smoothing.h"
#include "host/infer/inference.h"

namespace vitrine {

void save_solved_texture(const Store& store, const StoreKey& key, const TextureSize& size, const SolvedTexture& texture);
// Throws InputError where the store has it no more.
SolvedTexture load_solved_texture(const Store& store, const StoreKey& key);

// Textures of all fields, smoothed over the axes block by block: stored beside the others, whose keys they replace. Blocks that
// the store has already are not made again. Asks `progress` for interruptions.
void smooth_fields(const Store& store, float strength, Inference& inference, Progress& progress);

}  // namespace vitrine
