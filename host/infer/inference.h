// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Texture inference (Hakura 2001, chapter 3): for every object, layer and sample the texture with which the target's own
// rasterizer reproduces the traced frame best.
//
//   min over x  || W (A x - b) ||^2 + e_f (n_s / n_t) Gamma(x)
//
// x is the finest MIP level alone: the target makes the coarser ones from it by target/mip.h, so the rendering matrix read
// off the device (all levels) is multiplied by that decimation. W weights a pixel by its coverage. Gamma is the squared
// difference between each level and the bilinearly interpolated next coarser one (section 3.5.3); it fills what no pixel sees.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "formats/block.h"
#include "formats/mesh.h"
#include "formats/parameter_space.h"
#include "formats/texture_map.h"
#include "hal/gpu.h"
#include "host/base/progress.h"
#include "host/frames/store.h"
#include "host/scene/scene.h"
#include "target/draw/surface_filter.h"

namespace vitrine {

// An object as the target draws it: its mesh with coordinates in [0, 1]^2, onto which textures are laid by maps.
struct DrawnObject {
  int object = 0;                    // index into Scene::objects
  std::vector<MeshVertex> vertices;  // node space, on the grid
  MeshGrid grid;
  std::vector<uint32_t> indices;
  std::vector<uint32_t> triangles;  // per triangle of `indices`: its number in the object's Geometry
  uint32_t culled_index_count = 0;  // the first of them are single-sided
};

struct TextureSize {
  int width = 0, height = 0;  // texels
  auto operator<=>(const TextureSize&) const = default;
};

// A texture's size, and how it lies on its object's mesh.
struct Placement {
  TextureSize size;
  TextureMap map;
  bool operator==(const Placement&) const = default;
};

// One layer of one object over the axes on which it depends.
struct Field {
  int drawn_object = 0;  // index into Inference::objects
  std::string layer;     // "diffuse", "specular"
  AxisMask axes = 0;
  ParameterSpace space;  // the scene's, restricted to `axes`
  AxisSizes block_size{}, stagger{};
  int texture_width = 0, texture_height = 0;
  TextureSize size() const { return {texture_width, texture_height}; }
  std::vector<TextureMap> maps;      // of textures onto the object's mesh
  std::vector<uint16_t> block_maps;  // per block (as FieldShape numbers them): which of them; empty: all the first
  std::vector<StoreKey> textures;    // per sample of `space` (flat): planes "R", "G", "B": linear radiance; row 0 is v = 0
  // Per map and texel of the finest level: screen pixels that it feeds, mean over all frames that show it so.
  std::vector<std::vector<float>> importance;
};

struct Inference {
  std::vector<DrawnObject> objects;   // only those that some frame shows
  std::vector<Field> fields;          // only layers that carry light
  std::vector<std::string> warnings;  // one line each: objects that no light reaches, ...
};

// How fine textures are (host/infer/texture_coordinates.h).
struct TextureFitOptions {
  float stretch_bound = 1.25f;    // output pixels along a texel, at most
  float stretch_share = 0.90f;    // of what is seen keeps to that; 1: all
  float texels_per_pixel = 1.0f;  // along one dimension: scales the map that keeps to the bound
};

enum class TextureLayout : uint8_t {
  kFitted,  // a map for what each block shows
  // What fitted ones are measured against: the mesh's own coordinates as they are, in a texture of the shape that suits them
  // best, and in a square one, as artists paint it.
  kWholeDomain,
  kSquareDomain,
};

struct InferenceOptions {
  int width = 640, height = 480, supersampling = 2;
  SurfaceFilter filter = SurfaceFilter::kTrilinear;  // with which the target will read textures
  float regularization = 0.3f;                       // e_f
  float range_regularization = 0;                    // e_b (range_penalty.h)
  int iterations = 40;                               // of conjugate gradients, at most
  TextureLayout layout = TextureLayout::kFitted;
  TextureFitOptions fit;       // texels_per_pixel: before the objects' own scales
  float between_share = 0.5f;  // what a row of a picture between grid samples counts beside one of a grid sample's own
  float axis_smoothing = 0;    // of samples of a block towards each other (host/infer/axis_smoothing.h); 0: none
  int max_texture_size = 1024;
};

// `frames`: keys of all grid samples, flat order; and, for textures that are also solved for what they show between samples,
// after them those of between_samples() (host/infer/fields.h). All are in the store. `gpu`: a device with float targets. Results
// go to the store texture by texture and are taken from there when they are found, so an interrupted run resumes; the result does
// not depend on how often it was interrupted nor on the number of threads.
Inference infer_textures(const Scene& scene, const std::vector<StoreKey>& frames, const Store& store, hal::Gpu& gpu,
                         const InferenceOptions& options, Progress& progress);

}  // namespace vitrine
