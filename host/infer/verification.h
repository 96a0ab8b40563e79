// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What inference left in the store, and pictures drawn with it before any coding: the reference for how much of the error
// of an image is inference's.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "formats/parameter_space.h"
#include "hal/gpu.h"
#include "host/frames/store.h"
#include "host/infer/fields.h"
#include "host/infer/inference.h"
#include "host/infer/test_renderer.h"
#include "host/scene/scene.h"
#include "target/draw/scene_drawer.h"

namespace vitrine {

struct LinearTexture {
  int width = 0, height = 0;
  std::vector<glm::vec3> texels;  // linear radiance, rows v = 0 first
};

// The texture of a field at sample `flat` of its space. Throws InputError where the store has it no more.
LinearTexture load_field_texture(const Store& store, const Field& field, int64_t flat);

// A texture and where it lies on its object's mesh.
struct LaidTexture {
  LinearTexture texture;
  TextureMap map;
};
// Those of `layers` that a drawn object has, at a grid sample (flat number in the scene's space). All: kLayers.
std::vector<LaidTexture> load_object_textures(const Store& store, const Scene& scene, const Inference& inference,
                                              std::span<const Layer> layers, int drawn_object, int64_t grid_sample);

// The supersampled picture of a state, rows bottom first; the textures of an object add. textures[i]: of object i.
std::vector<glm::vec4> draw_textures(TestRenderer& renderer, const GeometryState& state,
                                     const std::vector<std::vector<LaidTexture>>& textures);

// A texture on the device with all MIP levels by decimation (target/mip.h), as the engine makes them. `format`: kRgba32f or
// kRgba16f. Throws InputError where the device refuses.
hal::Texture upload_texture(hal::Gpu& gpu, SceneDrawer& drawer, const LinearTexture& texture, hal::TextureFormat format);

// What SceneDrawer::resolve computes of a supersampled picture (rows bottom first, as TestRenderer gives it), in linear light:
// `width` x `height` pixels, rows top first.
std::vector<glm::vec4> resolve_linear(std::span<const glm::vec4> samples, int width, int height, int supersampling);

// The picture at a grid sample drawn with the sums of `layers` of the inferred textures, resolved with the pixel filter: linear
// radiance, rows top first, `options.width` x `options.height`. kLayers gives what the frames show; one layer alone what it
// gives to that, on surfaces that are black where they lack it.
std::vector<glm::vec3> draw_inferred(const Store& store, const Scene& scene, const Inference& inference,
                                     std::span<const Layer> layers, const InferenceOptions& options, hal::Gpu& gpu,
                                     int64_t grid_sample);

}  // namespace vitrine
