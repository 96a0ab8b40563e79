// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Textures as Vitrine codes them, in several ways, linked to an image and played by the engine.
#pragma once

#include <span>
#include <vector>

#include "host/base/progress.h"
#include "host/bench/compression.h"
#include "host/compile/compile.h"

namespace vitrine {

enum class Layers : uint8_t { kSeparated, kCombined };

// A way of coding: one row of coded_textures.cpp's table.
struct TextureCoder {
  const char* name;
  Layers layers = Layers::kSeparated;
  EncodeOptions options;  // without a target
};
std::span<const TextureCoder> texture_coders();

// Keys of frames in which every object has one layer alone, which depends on all axes: the sum of both. `frames`: of the scene's
// samples; the new ones go to the same store.
std::vector<StoreKey> combine_layers(const Scene& scene, const std::vector<StoreKey>& frames, const Store& store,
                                     Progress& progress);

// What an image holds beside its textures: meshes, the rig, the directory.
double geometry_bytes(const Scene& scene, const Inference& inference, const Store& store, const Profile& profile,
                      Progress& progress);

// `truth`: the traced pictures of all samples. `bytes`: the targets, of the textures alone.
CompressionSeries measure_coded_textures(const Scene& scene, const Inference& inference, const TextureCoder& coder,
                                         const Store& store, const Profile& profile, const std::vector<Picture>& truth,
                                         std::span<const double> bytes, Progress& progress);

}  // namespace vitrine
