// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/shading_material.h"

#include "host/trace/fresnel.h"

namespace vitrine::trace {
namespace {

using Albedos = std::map<float, std::shared_ptr<const GlassAlbedo>>;

// glTF: an ior of 0 stands for infinity.
float index_of(const Material& m) { return m.ior == 0 ? 1e4f : std::max(m.ior, 1.0f); }

glm::vec3 absorption_of(const Material& m) {
  if (m.attenuation_distance <= 0 || !std::isfinite(m.attenuation_distance)) return glm::vec3(0);
  return -glm::log(glm::clamp(m.attenuation_color, glm::vec3(1e-6f), glm::vec3(1))) / m.attenuation_distance;
}

// What textures may vary beside the base colour.
struct Properties {
  glm::vec2 metallic_roughness;
  float transmission, specular;
  glm::vec3 specular_color;
  float coat, coat_roughness;
};

// By the factors alone.
Properties factors_of(const Material& m) {
  return {glm::clamp(glm::vec2(m.metallic, m.roughness), glm::vec2(0), glm::vec2(1)), m.transmission, m.specular, m.specular_color,
          m.clearcoat, m.clearcoat_roughness};
}

// For a white base.
SurfaceParameters parameters_of(const ShadingMaterial& material, const Properties& q) {
  const float metallic = q.metallic_roughness.x;
  SurfaceParameters p;
  p.alpha = sqr(q.metallic_roughness.y);
  p.ior = material.ior;
  p.dielectric_f0 = q.specular * glm::min(normal_reflectance(material.ior) * q.specular_color, glm::vec3(1));
  p.dielectric_f90 = glm::vec3(q.specular);
  p.dielectric = (1 - metallic) * (1 - q.transmission);
  p.metal = metallic;
  p.glass = (1 - metallic) * q.transmission;
  p.glass_specular = q.specular;
  p.glass_color = q.specular_color;
  p.thin = !material.solid;
  p.glass_albedo = material.glass_albedo.get();
  p.coat = q.coat;
  p.coat_alpha = sqr(std::clamp(q.coat_roughness, 0.0f, 1.0f));
  return p;
}

void prepare_optics(const Material& m, Albedos& albedos, ShadingMaterial& s) {
  const bool all_metal = m.metallic >= 1 && !m.metallic_roughness_texture;
  s.transmits = m.transmission > 0 && !all_metal && !m.unlit;
  s.solid = s.transmits && m.thickness > 0;
  s.cut = m.alpha_mode != AlphaMode::kOpaque;
  s.emits = !m.unlit && max_component(m.emissive) > 0;
  s.coated = !m.unlit && m.clearcoat > 0;
  s.culled = !m.double_sided && !s.transmits;
  s.plain = !s.transmits && !s.cut && !s.culled;
  s.smooth = sqr(m.roughness) < kDeltaAlpha;
  s.normal_mapped = m.normal_texture || m.clearcoat_normal_texture;
  if (!s.solid) return;
  s.absorption = absorption_of(m);
  if (s.smooth) return;
  auto& albedo = albedos[s.ior];
  if (!albedo) albedo = std::make_shared<const GlassAlbedo>(s.ior);
  s.glass_albedo = albedo;
}

ShadingMaterial prepare(const Material& m, Albedos& albedos) {
  ShadingMaterial s;
  s.source = &m;
  s.ior = index_of(m);
  prepare_optics(m, albedos, s);
  s.textured = m.metallic_roughness_texture || m.transmission_texture || m.specular_texture || m.specular_color_texture ||
               m.clearcoat_texture || m.clearcoat_roughness_texture;
  s.parameters = parameters_of(s, factors_of(m));
  return s;
}

TexturePoint sharp(const TexturePoint& point) { return {point.uv, {}}; }

// metallic, roughness
glm::vec2 metallic_roughness_at(const Textures& textures, const Material& m, const SurfacePoint& point) {
  glm::vec2 mr(m.metallic, m.roughness);
  if (m.metallic_roughness_texture) {
    const glm::vec4 t = textures.linear(m.metallic_roughness_texture, point);
    mr *= glm::vec2(t.b, t.g);
  }
  return glm::clamp(mr, glm::vec2(0), glm::vec2(1));
}

float transmission_at(const Textures& textures, const Material& m, const SurfacePoint& point) {
  if (m.transmission <= 0) return 0;
  return m.transmission * (m.transmission_texture ? textures.linear(m.transmission_texture, point).r : 1.0f);
}

float specular_at(const Textures& textures, const Material& m, const SurfacePoint& point) {
  return m.specular * (m.specular_texture ? textures.linear(m.specular_texture, point).a : 1.0f);
}

glm::vec3 specular_color_at(const Textures& textures, const Material& m, const SurfacePoint& point) {
  if (!m.specular_color_texture) return m.specular_color;
  return m.specular_color * glm::vec3(textures.srgb(m.specular_color_texture, point));
}

float coat_at(const Textures& textures, const Material& m, const TexturePoint& point) {
  return m.clearcoat * (m.clearcoat_texture ? textures.linear(m.clearcoat_texture, point).r : 1.0f);
}

float coat_roughness_at(const Textures& textures, const Material& m, const TexturePoint& point) {
  return m.clearcoat_roughness * (m.clearcoat_roughness_texture ? textures.linear(m.clearcoat_roughness_texture, point).g : 1.0f);
}

Properties properties_at(const Textures& textures, const Material& m, const SurfacePoint& point) {
  Properties q = factors_of(m);
  q.metallic_roughness = metallic_roughness_at(textures, m, point);
  q.transmission = transmission_at(textures, m, point);
  q.specular = specular_at(textures, m, point);
  q.specular_color = specular_color_at(textures, m, point);
  q.coat = coat_at(textures, m, point);
  q.coat_roughness = coat_roughness_at(textures, m, point);
  return q;
}

}  // namespace

std::vector<ShadingMaterial> prepare_materials(const Scene& scene) {
  static const Material plain;
  Albedos albedos;
  std::vector<ShadingMaterial> prepared;
  prepared.reserve(scene.materials.size() + 1);
  for (const Material& m : scene.materials) prepared.push_back(prepare(m, albedos));
  prepared.push_back(prepare(plain, albedos));
  return prepared;
}

glm::vec4 base_color_at(const Textures& textures, const ShadingMaterial& material, const SurfacePoint& point) {
  const Material& m = *material.source;
  glm::vec4 color = m.base_color * point.color;
  if (m.base_color_texture) color *= textures.srgb(m.base_color_texture, material.cut ? sharp(point) : static_cast<const TexturePoint&>(point));
  return color;
}

float alpha_at(const ShadingMaterial& material, const glm::vec4& base_color) {
  switch (material.source->alpha_mode) {
    case AlphaMode::kOpaque:
      return 1;
    case AlphaMode::kMask:
      return base_color.a >= material.source->alpha_cutoff ? 1.0f : 0.0f;
    case AlphaMode::kBlend:
      return std::clamp(base_color.a, 0.0f, 1.0f);
  }
  return 1;
}

glm::vec3 emission_at(const Textures& textures, const ShadingMaterial& material, const SurfacePoint& point) {
  const Material& m = *material.source;
  if (!m.emissive_texture) return m.emissive;
  return m.emissive * glm::vec3(textures.srgb(m.emissive_texture, sharp(point)));
}

glm::vec3 covered_emission_at(const Textures& textures, const ShadingMaterial& material, const SurfacePoint& point) {
  const glm::vec3 emission = emission_at(textures, material, point);
  return material.cut ? emission * alpha_at(material, base_color_at(textures, material, point)) : emission;
}

CoatShare coat_share_at(const Textures& textures, const ShadingMaterial& material, const SurfacePoint& point, float cosine) {
  if (!material.coated) return {};
  const Material& m = *material.source;
  const float coat = coat_at(textures, m, sharp(point));
  const float roughness = std::clamp(coat_roughness_at(textures, m, sharp(point)), 0.0f, 1.0f);
  return {1 - coat * coat_reflectance(reflection_albedo(cosine, roughness)),
          1 - coat * coat_reflectance(mean_reflection_albedo(roughness))};
}

SurfaceParameters parameters_at(const Textures& textures, const ShadingMaterial& material, const SurfacePoint& point,
                                const glm::vec3& base_color) {
  SurfaceParameters p = material.textured ? parameters_of(material, properties_at(textures, *material.source, point)) : material.parameters;
  const glm::vec3 base = glm::clamp(base_color, glm::vec3(0), glm::vec3(1));
  p.diffuse = base * p.dielectric;
  p.metal_f0 = base;
  p.glass_tint = base;
  return p;
}

glm::vec3 straight_transmittance(const Textures& textures, const ShadingMaterial& material, const SurfacePoint& point,
                                 const glm::vec3& base_color, float cosine, bool inside) {
  const Material& m = *material.source;
  const float metallic = m.metallic <= 0 ? 0 : metallic_roughness_at(textures, m, point).x;
  const float share = (1 - metallic) * transmission_at(textures, m, point);
  inside = inside && material.solid;  // a thin wall has no inside: its back is another front
  // Leaving at an angle of total reflection would be black; the straight line stands for the refracted path, which does leave.
  const float outer_cosine = inside ? safe_sqrt(1 - (1 - cosine * cosine) / sqr(material.ior)) : cosine;
  const float reflectance = fresnel_dielectric(outer_cosine, material.ior);
  // As the BSDF has it: KHR_materials_specular weighs what is reflected on the outside.
  const glm::vec3 reflected = inside ? glm::vec3(reflectance)
                                     : glass_reflectance(reflectance, normal_reflectance(material.ior),
                                                         specular_at(textures, m, point), specular_color_at(textures, m, point));
  return share * (1.0f - reflected) * base_color;
}

}  // namespace vitrine::trace
