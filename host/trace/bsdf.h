// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The scattering of one surface point: glTF 2.0 metallic-roughness (appendix B) with KHR ior, specular, transmission, volume and
// clearcoat, as lobes that can be evaluated and sampled together or apart, because the picture's layers keep them apart.
//
//   diffuse    Lambert under the dielectric, coupled to it so that both conserve energy seen from everywhere and light may run
//              either way: albedo (1 - A(wo)) (1 - A(wi)) / (pi mean(1 - A)), A being the dielectric's albedo (Kelemen &
//              Szirmay-Kalos 2001). The factor that depends on the view alone, (1 - A(wo)) / mean(1 - A), is kept apart:
//              the picture's layer `diffuse` goes without it, so that it is the same from everywhere.
//   specular   GGX with Schlick's Fresnel, metals and dielectrics in one lobe; what metals scatter more than once between facets
//              is a nearly diffuse part of it.
//   glass      exact dielectric Fresnel, refraction (solid) or straight-through transmission (thin-walled), smooth or rough;
//              what rough glass scatters more than once leaves nearly diffusely, to both sides.
//   coat       a second GGX layer of index 1.5 on top, with a normal of its own; all below is seen through what it does not
//              reflect towards the viewer (KHR_materials_clearcoat's rule, the one part that is not reciprocal).
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
  float dielectric = 0;                           // share of the surface that is an opaque dielectric
  float metal = 0;                                // share that is a metal
  glm::vec3 metal_f0{0};                          // its reflectance; at grazing angles it is 1
  float glass = 0;                                // share that transmits; with the two above at most 1
  float alpha = 1;                                // GGX width of specular and glass
  glm::vec3 glass_tint{1};                        // of transmitted light, per interface
  float glass_specular = 1;                       // scales outside reflections of glass
  glm::vec3 glass_color{1};                       // scales them at normal incidence
  float ior = 1.5f;                               // >= 1
  bool thin = true;
  const GlassAlbedo* glass_albedo = nullptr;  // of this index; without it rough solid glass loses light
  float coat = 0, coat_alpha = 0;
};

// f * |cos| of the lobes, and the densities per solid angle with which sample_diffuse and sample_specular would find wi.
struct BsdfValue {
  glm::vec3 diffuse{0};   // without Bsdf::view_factor()
  glm::vec3 specular{0};  // all other lobes
  float diffuse_pdf = 0, specular_pdf = 0;
};

// Which lobes evaluate() is asked for.
enum class Lobes : uint8_t { kDiffuse = 1, kSpecular = 2, kAll = 3 };

struct BsdfSample {
  glm::vec3 wi{0};
  bool delta = false;
  bool transmitted = false;  // through glass
  bool total = false;        // reflected where glass lets nothing out
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

  // What the diffuse lobe's value is to be multiplied by to be what wo sees; 1 in the mean over all views.
  const glm::vec3& view_factor() const { return view_factor_; }
  glm::vec3 seen(const BsdfValue& value) const { return value.diffuse * view_factor_ + value.specular; }
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
  float coat_albedo(float cosine) const;
  void add_glass_multiple(const glm::vec3& local, BsdfValue& value) const;
  glm::vec3 glass_reflected(float fresnel) const;
  void glass_split(float reflectance, glm::vec3& reflected, glm::vec3& transmitted, float& reflect_probability) const;
  float prepare_specular(const ReflectionAlbedo& albedo);
  void prepare_diffuse(const ReflectionAlbedo& albedo);
  void prepare_coat(const glm::vec3& normal, float& albedo_estimate);
  void prepare_glass(const ReflectionAlbedo& albedo);
  void prepare_glass_multiple(float missed, float crossing, float mean_here, float mean_there);
  bool sample_delta_glass(float lobe, float least_chance, BsdfSample& sample) const;
  bool sample_rough_glass(float lobe, const glm::vec2& u, BsdfSample& sample) const;

  SurfaceParameters p_;
  float roughness_;
  Basis base_, coat_;
  glm::vec3 wo_, geometric_, local_wo_, coat_wo_{0};
  bool inside_ = false, solid_ = false, has_dense_specular_ = false;
  float eta_ = 1;                            // index of the far side / of this side
  glm::vec3 specular_f0_{0}, specular_f90_{0};  // of metal and dielectric together, times their shares
  glm::vec3 view_factor_{1};
  glm::vec3 multiple_{0};      // of the specular lobe: value of multiple scattering / (cos * (1 - albedo of wi))
  float multiple_chance_ = 0;  // of drawing from it, within the lobe
  float glass_f0_ = 0;         // reflectance at normal incidence, before factor and colour
  float glass_missed_ = 0;     // by single scattering of glass, seen from wo
  float glass_crossing_ = 0;   // share of that which crosses
  glm::vec3 glass_returned_{0}, glass_crossed_{0};  // its value on this side and the far one / (cos * what is missed from wi)
  float base_share_ = 1;  // what the coat lets through to what is below, seen from wo
  float diffuse_weight_ = 0, specular_weight_ = 0;
  float specular_probability_ = 0, glass_probability_ = 0, coat_probability_ = 0;  // among specular lobes
};

}  // namespace vitrine::trace
