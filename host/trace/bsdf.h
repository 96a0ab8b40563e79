// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The scattering of one surface point: glTF 2.0 metallic-roughness (appendix B) with KHR ior, specular, transmission, volume and
// clearcoat, as lobes that can be evaluated and sampled together or apart, because the picture's layers keep them apart.
//
//   diffuse    Lambert under the dielectric. It gets what the layers above do not reflect of light from the *incident* side,
//              (1 - E(wi)): flux is conserved for every light direction and the lobe's radiance does not depend on the view,
//              which is what the layer `diffuse` promises to playback. (Seen at grazing angles a white dielectric so returns
//              slightly more than a reciprocal model would; its mean over views is exact.)
//   specular   GGX with Schlick's Fresnel, metals and dielectrics in one lobe; what metals scatter more than once between facets
//              is a nearly diffuse part of it.
//   glass      exact dielectric Fresnel, refraction (solid) or straight-through transmission (thin-walled), smooth or rough,
//              compensated so that clear glass neither gains nor loses light.
//   coat       a second GGX layer of index 1.5 on top, with a normal of its own.
//
// Directions point away from the surface and are in world space. Values include the cosine of wi.
#pragma once

#include <cstdint>

#include "host/trace/albedo.h"
#include "host/trace/vector_math.h"

namespace vitrine::trace {

// What materials and textures say at a point.
struct SurfaceParameters {
  glm::vec3 diffuse{0};                           // albedo of the diffuse lobe before layering
  glm::vec3 dielectric_f0{0}, dielectric_f90{0};  // reflectance of the dielectric over the diffuse lobe, in [0, 1]
  glm::vec3 specular_f0{0}, specular_f90{0};      // of the specular lobe, times its share (1 - glass)
  float alpha = 1;                                // GGX width of specular and glass
  float glass = 0;                                // share of the surface that transmits
  glm::vec3 glass_tint{1};                        // of transmitted light, per interface
  glm::vec3 glass_reflectance{1};                 // scales outside reflections of glass
  float ior = 1.5f;                               // > 0
  bool thin = true;
  const GlassAlbedo* glass_albedo = nullptr;  // needed where glass is rough and solid
  float coat = 0, coat_alpha = 0;
};

// f * |cos| of the lobes, and the densities per solid angle with which sample_diffuse and sample_specular would find wi.
struct BsdfValue {
  glm::vec3 diffuse{0}, specular{0};  // specular: all lobes but diffuse
  float diffuse_pdf = 0, specular_pdf = 0;
};

// Which lobes evaluate() is asked for.
enum class Lobes : uint8_t { kDiffuse = 1, kSpecular = 2, kAll = 3 };

struct BsdfSample {
  glm::vec3 wi{0};
  bool delta = false;
  bool transmitted = false;  // through glass
  glm::vec3 weight{0};       // delta only: f * |cos| / pdf among the specular lobes; others are weighed by evaluate()
};

class Bsdf {
 public:
  // `geometric`, `shading` and `coat` normals are unit and on the outside of a solid; wo may be on either side.
  Bsdf(const SurfaceParameters& parameters, const glm::vec3& wo, const glm::vec3& geometric, const glm::vec3& shading,
       const glm::vec3& coat);

  BsdfValue evaluate(const glm::vec3& wi, Lobes lobes = Lobes::kAll) const;
  // False where the direction carries nothing.
  bool sample_diffuse(const glm::vec2& u, BsdfSample& sample) const;
  // Smooth glass reflects and transmits with a chance of at least `least_chance` each, where it does both.
  bool sample_specular(float lobe, const glm::vec2& u, BsdfSample& sample, float least_chance = 0) const;

  bool has_diffuse() const { return diffuse_weight_ > 0; }
  bool has_specular() const { return specular_weight_ > 0; }
  // Both lobes' estimated albedos; the chance of the diffuse one where one lobe is drawn.
  float diffuse_probability() const { return diffuse_weight_ / (diffuse_weight_ + specular_weight_); }
  float specular_albedo() const { return specular_weight_; }
  // Whether any lobe has a density, so that lights can be sampled.
  bool has_density() const { return has_diffuse() || has_dense_specular_; }
  // No specular lobe is narrower than `alpha`, and none refracts.
  bool wide(float alpha) const { return p_.alpha >= alpha && p_.glass == 0 && p_.coat == 0; }
  bool inside() const { return inside_; }  // wo is inside of a solid
  bool solid() const { return solid_; }
  const glm::vec3& normal() const { return geometric_; }  // on the side of wo
  bool same_side(const glm::vec3& wi) const { return glm::dot(wi, geometric_) > 0; }

 private:
  bool reflection_is_delta() const { return p_.alpha < kDeltaAlpha; }
  bool glass_is_delta() const;
  void add_diffuse(const glm::vec3& wi, BsdfValue& value) const;
  void add_specular(const glm::vec3& wi, BsdfValue& value) const;
  void add_coat(const glm::vec3& wi, BsdfValue& value) const;
  void add_glass(const glm::vec3& wi, BsdfValue& value) const;
  glm::vec3 coat_share(float cosine) const;
  void glass_split(float reflectance, glm::vec3& reflected, glm::vec3& transmitted, float& reflect_probability) const;
  void prepare_specular(const ReflectionAlbedo& albedo, float& albedo_estimate);
  bool sample_delta_glass(float lobe, float least_chance, BsdfSample& sample) const;
  bool sample_rough_glass(float lobe, const glm::vec2& u, BsdfSample& sample) const;

  SurfaceParameters p_;
  Basis base_, coat_;
  glm::vec3 wo_, geometric_, local_wo_, coat_wo_{0};
  bool inside_ = false, solid_ = false, has_dense_specular_ = false;
  float eta_ = 1;              // index of the far side / of this side
  glm::vec3 multiple_{0};      // of the specular lobe: value of multiple scattering / (cos * (1 - albedo of wi))
  float multiple_chance_ = 0;  // of drawing from it, within the lobe
  float glass_compensation_ = 1;
  float base_share_ = 1;  // what the coat lets through to the specular lobes, seen from wo
  float diffuse_weight_ = 0, specular_weight_ = 0;
  float specular_probability_ = 0, glass_probability_ = 0, coat_probability_ = 0;  // among specular lobes
};

}  // namespace vitrine::trace
