// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/bsdf.h"

#include "host/trace/fresnel.h"
#include "host/trace/warp.h"

namespace vitrine::trace {
namespace {

constexpr float kCoatF0 = 0.04f;  // index 1.5
constexpr float kMinCosine = 1e-4f;

// The mean over the hemisphere of a dielectric's reflectance, by Schlick's approximation.
float mean_reflectance(float f0) { return f0 + (1 - f0) / 21; }

glm::vec3 mirror(const glm::vec3& w, const glm::vec3& h) { return 2 * glm::dot(w, h) * h - w; }

// The shading normal, on wo's side and bent just far enough that wo sees its front and its mirror image does not lie behind the
// surface (else the point would be black).
glm::vec3 visible_normal(const glm::vec3& shading, const glm::vec3& geometric, const glm::vec3& wo) {
  constexpr float kLeast = 0.01f;
  const float cosine = glm::dot(shading, wo);
  const glm::vec3 seen = cosine > kLeast ? shading : glm::normalize(shading + (kLeast - cosine) * wo);
  if (glm::dot(seen, geometric) > 0.9999f) return seen;
  const glm::vec3 mirrored = mirror(wo, seen);
  const float height = glm::dot(mirrored, geometric);
  return height > 0 ? seen : glm::normalize(wo + glm::normalize(mirrored + (kLeast - height) * geometric));
}

// A GGX reflection lobe of Fresnel 1: value without Fresnel, and density.
struct Reflection {
  glm::vec3 half;
  float value, pdf;
};
Reflection reflection_of(const Ggx& ggx, const glm::vec3& wo, const glm::vec3& wi) {
  const glm::vec3 h = glm::normalize(wo + wi);
  const float d = ggx.density(h) / (4 * wo.z);
  const float lambda_o = ggx.lambda(wo);
  return {h, d / (1 + lambda_o + ggx.lambda(wi)), d / (1 + lambda_o)};
}

}  // namespace

Bsdf::Bsdf(const SurfaceParameters& parameters, const glm::vec3& wo, const glm::vec3& geometric, const glm::vec3& shading,
           const glm::vec3& coat)
    : p_(parameters), wo_(wo), geometric_(geometric) {
  const bool back = glm::dot(wo, geometric) < 0;
  const float side = back ? -1.0f : 1.0f;
  geometric_ = side * geometric;
  base_ = Basis(visible_normal(side * shading, geometric_, wo));
  local_wo_ = base_.to_local(wo);
  local_wo_.z = std::max(local_wo_.z, kMinCosine);
  solid_ = p_.glass > 0 && !p_.thin;
  inside_ = solid_ && back;
  eta_ = inside_ ? 1 / p_.ior : p_.ior;
  roughness_ = std::sqrt(p_.alpha);
  specular_f0_ = p_.dielectric * p_.dielectric_f0 + p_.metal * p_.metal_f0;
  specular_f90_ = p_.dielectric * p_.dielectric_f90 + glm::vec3(p_.metal);

  float coated = 0;
  if (p_.coat > 0) prepare_coat(side * coat, coated);
  const bool reflects = p_.glass > 0 || !is_black(specular_f90_) || !is_black(specular_f0_);
  const ReflectionAlbedo albedo = reflects ? reflection_albedo(local_wo_.z, roughness_) : ReflectionAlbedo{0, 0};
  prepare_diffuse(albedo);
  if (p_.glass > 0) glass_f0_ = normal_reflectance(p_.ior);
  if (p_.glass > 0 && !glass_is_delta()) prepare_glass(albedo);
  const float specular = base_share_ * prepare_specular(albedo);
  const float glass = base_share_ * p_.glass;
  specular_weight_ = specular + glass + coated;
  if (specular_weight_ > 0) {
    specular_probability_ = specular / specular_weight_;
    glass_probability_ = glass / specular_weight_;
    coat_probability_ = coated / specular_weight_;
  }
  has_dense_specular_ = (specular > 0 && !reflection_is_delta()) || (glass > 0 && !glass_is_delta()) ||
                        (coated > 0 && p_.coat_alpha >= kDeltaAlpha);
}

void Bsdf::prepare_coat(const glm::vec3& normal, float& albedo_estimate) {
  coat_ = Basis(visible_normal(normal, geometric_, wo_));
  coat_wo_ = coat_.to_local(wo_);
  coat_wo_.z = std::max(coat_wo_.z, kMinCosine);
  albedo_estimate = coat_albedo(coat_wo_.z);
  base_share_ = 1 - albedo_estimate;
}

void Bsdf::prepare_diffuse(const ReflectionAlbedo& albedo) {
  if (is_black(p_.diffuse)) return;
  if (p_.coat > 0) {
    const ReflectionAlbedo mean = mean_reflection_albedo(std::sqrt(p_.coat_alpha));
    const float kept_in_the_mean = 1 - p_.coat * coat_reflectance(mean);
    p_.diffuse *= kept_in_the_mean;
    view_factor_ *= base_share_ / kept_in_the_mean;
  }
  if (!is_black(p_.dielectric_f90)) {
    const ReflectionAlbedo mean = mean_reflection_albedo(roughness_);
    const glm::vec3 kept = 1.0f - albedo.schlick(p_.dielectric_f0, p_.dielectric_f90);
    const glm::vec3 kept_in_the_mean = 1.0f - mean.schlick(p_.dielectric_f0, p_.dielectric_f90);
    view_factor_ *= glm::max(kept, glm::vec3(0)) / glm::max(kept_in_the_mean, glm::vec3(1e-4f));
  }
  diffuse_weight_ = luminance(p_.diffuse * view_factor_);
}

float Bsdf::prepare_specular(const ReflectionAlbedo& albedo) {
  const float single = luminance(albedo.schlick(specular_f0_, specular_f90_));
  if (reflection_is_delta() || !(p_.metal > 0)) return single;  // what dielectrics lose goes to the diffuse lobe
  const float mean = mean_reflection_albedo(roughness_).white;
  const glm::vec3 returned = p_.metal * multiple_scattering(p_.metal_f0, glm::vec3(1), mean);
  multiple_ = returned * ((1 - albedo.white) / std::max(1 - mean, 1e-6f) * kInvPi);
  const float multiple = luminance(returned) * (1 - albedo.white);
  multiple_chance_ = single + multiple > 0 ? multiple / (single + multiple) : 0;
  return single + multiple;
}

void Bsdf::prepare_glass(const ReflectionAlbedo& albedo) {
  if (p_.thin) {  // air on both sides: what one interface reflects and lets through, in the mean
    const float mean = 1 - mean_reflection_albedo(roughness_).white;
    prepare_glass_multiple(1 - albedo.white, 1 - mean_reflectance(glass_f0_), mean, mean);
  } else if (p_.glass_albedo) {
    prepare_glass_multiple(1 - p_.glass_albedo->lookup(local_wo_.z, roughness_, inside_),
                           p_.glass_albedo->crossing(roughness_, inside_), p_.glass_albedo->mean_missing(roughness_, inside_),
                           p_.glass_albedo->mean_missing(roughness_, !inside_));
  }
}

// Kulla & Conty 2017, p. 20: missed(wo) missed(wi) over the mean of the side that wi is on, in the shares of reflection and
// crossing; in radiance, as add_glass. `crossing` is before factor and colour.
void Bsdf::prepare_glass_multiple(float missed, float crossing, float mean_here, float mean_there) {
  const float mean = mean_reflectance(glass_f0_);
  const glm::vec3 returning = glm::min(glass_reflected(mean) * ((1 - crossing) / mean), glm::vec3(1));
  // Of a solid's reflections a factor or colour takes more than it gives to what crosses: the table does not know of either.
  const glm::vec3 passing = p_.thin ? 1.0f - returning : glm::min(1.0f - returning, glm::vec3(crossing));
  glass_missed_ = std::max(missed, 0.0f);
  glass_crossing_ = crossing;
  glass_returned_ = returning * (glass_missed_ * kInvPi / std::max(mean_here, 1e-6f));
  glass_crossed_ = passing * p_.glass_tint * (glass_missed_ * kInvPi / std::max(mean_there, 1e-6f));
  if (solid_) glass_crossed_ /= eta_ * eta_;
}

bool Bsdf::glass_is_delta() const {
  // Without a step in index rough refraction has no defined half vector, and nothing bends.
  return p_.alpha < kDeltaAlpha || std::fabs(p_.ior - 1) < 1e-3f;
}

float Bsdf::coat_albedo(float cosine) const {
  return p_.coat * coat_reflectance(reflection_albedo(cosine, std::sqrt(p_.coat_alpha)));
}

glm::vec3 Bsdf::glass_reflected(float fresnel) const {
  return inside_ ? glm::vec3(fresnel) : glass_reflectance(fresnel, glass_f0_, p_.glass_specular, p_.glass_color);
}

void Bsdf::glass_split(float reflectance, glm::vec3& reflected, glm::vec3& transmitted, float& reflect_probability) const {
  reflected = glass_reflected(reflectance);
  transmitted = reflectance >= 1 ? glm::vec3(0) : (1.0f - reflected) * p_.glass_tint;
  const float r = luminance(reflected), t = luminance(transmitted);
  reflect_probability = r + t > 0 ? r / (r + t) : 1;
}

BsdfValue Bsdf::evaluate(const glm::vec3& wi, Lobes lobes) const {
  BsdfValue value;
  const bool reflected = same_side(wi);
  if (reflected && has_diffuse() && lobes != Lobes::kSpecular) add_diffuse(wi, value);
  if (has_dense_specular_ && lobes != Lobes::kDiffuse) {
    if (reflected && specular_probability_ > 0 && !reflection_is_delta()) add_specular(wi, value);
    if (reflected && coat_probability_ > 0 && p_.coat_alpha >= kDeltaAlpha) add_coat(wi, value);
    if (glass_probability_ > 0 && !glass_is_delta()) add_glass(wi, value);
  }
  return value;
}

void Bsdf::add_diffuse(const glm::vec3& wi, BsdfValue& value) const {
  const float cosine = glm::dot(wi, base_.normal);
  if (cosine <= 0) return;
  glm::vec3 kept(1);
  if (!is_black(p_.dielectric_f90)) {
    kept -= reflection_albedo(cosine, roughness_).schlick(p_.dielectric_f0, p_.dielectric_f90);
  }
  value.diffuse = p_.diffuse * glm::max(kept, glm::vec3(0)) * (cosine * kInvPi);
  value.diffuse_pdf = cosine * kInvPi;
}

void Bsdf::add_specular(const glm::vec3& wi, BsdfValue& value) const {
  const glm::vec3 local = base_.to_local(wi);
  if (local.z <= 0) return;
  const Reflection r = reflection_of(Ggx{p_.alpha}, local_wo_, local);
  const float edge = schlick_weight(glm::dot(local_wo_, r.half));
  value.specular += (specular_f0_ + edge * (specular_f90_ - specular_f0_)) * (base_share_ * r.value);
  float pdf = r.pdf;
  if (multiple_chance_ > 0) {
    const float missed = 1 - reflection_albedo(local.z, roughness_).white;
    value.specular += multiple_ * (base_share_ * missed * local.z);
    pdf += multiple_chance_ * (local.z * kInvPi - r.pdf);
  }
  value.specular_pdf += specular_probability_ * pdf;
}

void Bsdf::add_coat(const glm::vec3& wi, BsdfValue& value) const {
  const glm::vec3 local = coat_.to_local(wi);
  if (local.z <= 0) return;
  const Reflection r = reflection_of(Ggx{p_.coat_alpha}, coat_wo_, local);
  const float fresnel = kCoatF0 + (1 - kCoatF0) * schlick_weight(glm::dot(coat_wo_, r.half));
  value.specular += p_.coat * fresnel * r.value;
  value.specular_pdf += coat_probability_ * r.pdf;
}

void Bsdf::add_glass(const glm::vec3& wi, BsdfValue& value) const {
  const Ggx ggx{p_.alpha};
  glm::vec3 local = base_.to_local(wi), reflected, transmitted;
  float reflect_probability;
  const float share = p_.glass * base_share_;
  const bool reflection = local.z > 0;
  if (local.z == 0 || reflection != same_side(wi)) return;
  if (glass_missed_ > 0) add_glass_multiple(local, value);
  if (reflection || p_.thin) {  // a thin wall transmits the mirror image of its reflection lobe
    local.z = std::fabs(local.z);
    const Reflection r = reflection_of(ggx, local_wo_, local);
    glass_split(fresnel_dielectric(glm::dot(local_wo_, r.half), eta_), reflected, transmitted, reflect_probability);
    value.specular += (reflection ? reflected : transmitted) * (share * r.value);
    value.specular_pdf += glass_probability_ * (1 - glass_missed_) * (reflection ? reflect_probability : 1 - reflect_probability) * r.pdf;
    return;
  }
  // Walter et al. 2007, eqs. 16, 17 and 21, in radiance: divided by the square of the relative index.
  glm::vec3 h = glm::normalize(local_wo_ + local * eta_);
  if (h.z < 0) h = -h;
  const float out = glm::dot(local_wo_, h), in = glm::dot(local, h);
  if (out <= 0 || in >= 0) return;
  glass_split(fresnel_dielectric(out, eta_), reflected, transmitted, reflect_probability);
  const float jacobian = -in / sqr(in + out / eta_);
  const float d = ggx.density(h) * out * jacobian / local_wo_.z;
  const float lambda_o = ggx.lambda(local_wo_);
  value.specular += transmitted * (share * d / ((1 + lambda_o + ggx.lambda(local)) * eta_ * eta_));
  value.specular_pdf += glass_probability_ * (1 - glass_missed_) * (1 - reflect_probability) * d / (1 + lambda_o);
}

void Bsdf::add_glass_multiple(const glm::vec3& local, BsdfValue& value) const {
  const bool reflection = local.z > 0;
  const float cosine = std::fabs(local.z);
  const bool arrives_inside = solid_ && inside_ == reflection;
  const float missed = p_.thin ? 1 - reflection_albedo(cosine, roughness_).white
                               : 1 - p_.glass_albedo->lookup(cosine, roughness_, arrives_inside);
  value.specular += (reflection ? glass_returned_ : glass_crossed_) * (p_.glass * base_share_ * std::max(missed, 0.0f) * cosine);
  value.specular_pdf += glass_probability_ * glass_missed_ * (reflection ? 1 - glass_crossing_ : glass_crossing_) * cosine * kInvPi;
}

bool Bsdf::sample_diffuse(const glm::vec2& u, BsdfSample& sample) const {
  sample = {};
  sample.wi = base_.to_world(cosine_hemisphere(u));
  return same_side(sample.wi);
}

bool Bsdf::sample_specular(float lobe, const glm::vec2& u, BsdfSample& sample, float least_chance) const {
  sample = {};
  if (lobe < specular_probability_) {
    if (reflection_is_delta()) {
      const float edge = schlick_weight(local_wo_.z);
      sample.wi = base_.to_world({-local_wo_.x, -local_wo_.y, local_wo_.z});
      sample.weight = (specular_f0_ + edge * (specular_f90_ - specular_f0_)) * (base_share_ / specular_probability_);
      sample.delta = true;
      return same_side(sample.wi);
    }
    // The lobe's number tells single from multiple scattering, too.
    const bool multiple = lobe < specular_probability_ * multiple_chance_;
    sample.wi = base_.to_world(multiple ? cosine_hemisphere(u) : mirror(local_wo_, Ggx{p_.alpha}.sample_visible(local_wo_, u)));
    return same_side(sample.wi);
  }
  if (lobe < specular_probability_ + glass_probability_) {
    const float rest = (lobe - specular_probability_) / glass_probability_;
    return glass_is_delta() ? sample_delta_glass(rest, least_chance, sample) : sample_rough_glass(rest, u, sample);
  }
  if (p_.coat_alpha < kDeltaAlpha) {
    sample.wi = coat_.to_world({-coat_wo_.x, -coat_wo_.y, coat_wo_.z});
    sample.weight = glm::vec3(coat_albedo(coat_wo_.z) / coat_probability_);
    sample.delta = true;
    return same_side(sample.wi);
  }
  sample.wi = coat_.to_world(mirror(coat_wo_, Ggx{p_.coat_alpha}.sample_visible(coat_wo_, u)));
  return same_side(sample.wi);
}

bool Bsdf::sample_delta_glass(float lobe, float least_chance, BsdfSample& sample) const {
  glm::vec3 reflected, transmitted;
  float reflect_probability;
  glass_split(fresnel_dielectric(local_wo_.z, eta_), reflected, transmitted, reflect_probability);
  if (reflect_probability > 0 && reflect_probability < 1)
    reflect_probability = std::clamp(reflect_probability, least_chance, 1 - least_chance);
  const float share = p_.glass * base_share_ / glass_probability_;
  sample.delta = true;
  if (lobe < reflect_probability) {
    sample.total = reflect_probability == 1;
    sample.wi = base_.to_world({-local_wo_.x, -local_wo_.y, local_wo_.z});
    sample.weight = reflected * (share / reflect_probability);
    return same_side(sample.wi);
  }
  sample.transmitted = true;
  sample.weight = transmitted * (share / (1 - reflect_probability));
  if (p_.thin) {
    sample.wi = -wo_;
    return true;
  }
  glm::vec3 local;
  if (!refract(local_wo_, {0, 0, 1}, eta_, local)) return false;
  sample.wi = base_.to_world(local);
  sample.weight /= eta_ * eta_;
  return !same_side(sample.wi);
}

bool Bsdf::sample_rough_glass(float lobe, const glm::vec2& u, BsdfSample& sample) const {
  glm::vec3 reflected, transmitted;
  float reflect_probability;
  if (lobe < glass_missed_) {  // several times between facets
    glm::vec3 local = cosine_hemisphere(u);
    sample.transmitted = lobe < glass_missed_ * glass_crossing_;
    if (sample.transmitted) local.z = -local.z;
    sample.wi = base_.to_world(local);
    return same_side(sample.wi) != sample.transmitted;
  }
  lobe = std::min((lobe - glass_missed_) / (1 - glass_missed_), 0x1.fffffep-1f);
  const glm::vec3 h = Ggx{p_.alpha}.sample_visible(local_wo_, u);
  glass_split(fresnel_dielectric(glm::dot(local_wo_, h), eta_), reflected, transmitted, reflect_probability);
  glm::vec3 local = mirror(local_wo_, h);
  sample.transmitted = lobe >= reflect_probability;
  sample.total = reflect_probability == 1;
  if (sample.transmitted) {
    if (p_.thin) {
      local.z = -local.z;
    } else if (!refract(local_wo_, h, eta_, local)) {
      return false;
    }
  }
  if ((local.z < 0) != sample.transmitted) return false;
  sample.wi = base_.to_world(local);
  return same_side(sample.wi) != sample.transmitted;
}

}  // namespace vitrine::trace
