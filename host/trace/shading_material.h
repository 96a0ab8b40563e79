// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A glTF material prepared for rays: what a hit has to ask of it, and its BSDF parameters at a point.
#pragma once

#include <map>
#include <memory>

#include "host/scene/scene.h"
#include "host/trace/bsdf.h"
#include "host/trace/texture.h"

namespace vitrine::trace {

struct ShadingMaterial {
  const Material* source = nullptr;
  bool transmits = false;  // some point of it is glass
  bool solid = false;      // glass with an inside (KHR_materials_volume)
  bool cut = false;        // alpha counts
  bool emits = false;
  bool coated = false;      // some point of it
  bool culled = false;      // single-sided: rays from behind go on
  bool plain = false;       // every ray that meets it is stopped by it: no filter needed
  bool smooth = false;      // glass that does not blur
  bool normal_mapped = false;
  bool textured = false;          // by more than the base colour
  float ior = 1.5f;               // index of refraction, finite and >= 1 also where the file's 0 stands for infinity
  SurfaceParameters parameters;   // where nothing is textured, for a white base
  glm::vec3 absorption{0};  // per metre, inside of a solid (Beer-Lambert)
  std::shared_ptr<const GlassAlbedo> glass_albedo;
};

// One per Scene::materials, then a default material for index -1 as the last.
std::vector<ShadingMaterial> prepare_materials(const Scene& scene);

// What a point of a surface hands to its material.
struct SurfacePoint : TexturePoint {
  glm::vec4 color{1};  // vertex colour
};

// Cut-outs keep their edges: where alpha counts, the finest level is read.
glm::vec4 base_color_at(const Textures& textures, const ShadingMaterial& material, const SurfacePoint& point);
// The share of rays that the surface stops: 0 or 1 where it masks.
float alpha_at(const ShadingMaterial& material, const glm::vec4& base_color);
// Always of the finest level: light is found by looking and by sampling it, and must be the same.
glm::vec3 emission_at(const Textures& textures, const ShadingMaterial& material, const SurfacePoint& point);
// The same for a surface whose alpha stops only a share of the rays: emission times that share.
glm::vec3 covered_emission_at(const Textures& textures, const ShadingMaterial& material, const SurfacePoint& point);
// Of light from below the coat, the share that leaves at the point under `cosine` to the normal, and in the mean over the
// hemisphere; 1 without a coat. As for emission, of the finest level.
struct CoatShare {
  float seen = 1, mean = 1;
};
CoatShare coat_share_at(const Textures& textures, const ShadingMaterial& material, const SurfacePoint& point, float cosine);
SurfaceParameters parameters_at(const Textures& textures, const ShadingMaterial& material, const SurfacePoint& point,
                                const glm::vec3& base_color);
// What one crossing of the surface lets through in a straight line, seen under `cosine`; alpha not counted.
glm::vec3 straight_transmittance(const Textures& textures, const ShadingMaterial& material, const SurfacePoint& point,
                                 const glm::vec3& base_color, float cosine, bool inside);

}  // namespace vitrine::trace
