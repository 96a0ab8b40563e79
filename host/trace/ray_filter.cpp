// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/ray_filter.h"

namespace vitrine::trace {
namespace {

// Cosine between the ray and the triangle's front normal, in the object's space (a mirrored instance mirrors its winding, and
// glTF 3.7.4 counts it mirrored): negative where the front is met.
float facing(const RTCRay& ray, const RTCHit& hit) { return ray.dir_x * hit.Ng_x + ray.dir_y * hit.Ng_y + ray.dir_z * hit.Ng_z; }

// The cosine in world space, for Fresnel.
float world_cosine(const PosedObject& posed, const RTCRay& ray, const RTCHit& hit) {
  const glm::vec3 n = posed.normal_from_object * glm::vec3(hit.Ng_x, hit.Ng_y, hit.Ng_z);
  const glm::vec3 d = glm::mat3(posed.world_from_object) * glm::vec3(ray.dir_x, ray.dir_y, ray.dir_z);
  return std::fabs(glm::dot(n, d)) / std::max(glm::length(n) * glm::length(d), 1e-30f);
}

// What the surface lets through to a shadow ray; black: all is stopped.
glm::vec3 transmittance_of(const PosedObject& posed, const ShadingMaterial& material, const RTCRay& ray, const RTCHit& hit,
                           ShadowContext& context) {
  const SurfacePoint point = posed.point_at(static_cast<int>(hit.primID), hit.u, hit.v);
  const glm::vec4 base = base_color_at(*posed.textures, material, point);
  const float alpha = alpha_at(material, base);
  glm::vec3 passed(1 - alpha);
  const bool bends = material.solid || !material.smooth;
  if (!material.transmits || alpha == 0 || (bends && !context.may_cross_glass)) return passed;
  const bool leaving = facing(ray, hit) > 0;
  passed += alpha * straight_transmittance(*posed.textures, material, point, base, world_cosine(posed, ray, hit), leaving);
  if (bends) context.crossed_glass = true;
  if (material.solid) {
    const glm::vec3 a = leaving ? material.absorption : -material.absorption;
    context.depth += a * ray.tfar;
    context.inside -= a;
  }
  return passed;
}

}  // namespace

void filter_intersection(const RTCFilterFunctionNArguments* arguments) {
  const auto& posed = *static_cast<const PosedObject*>(arguments->geometryUserPtr);
  const auto& ray = *reinterpret_cast<const RTCRay*>(arguments->ray);
  const auto& hit = *reinterpret_cast<const RTCHit*>(arguments->hit);
  if (posed.material(hit.primID).culled && facing(ray, hit) > 0) arguments->valid[0] = 0;
}

void filter_occlusion(const RTCFilterFunctionNArguments* arguments) {
  const auto& posed = *static_cast<const PosedObject*>(arguments->geometryUserPtr);
  const auto& ray = *reinterpret_cast<const RTCRay*>(arguments->ray);
  const auto& hit = *reinterpret_cast<const RTCHit*>(arguments->hit);
  const ShadingMaterial& material = posed.material(hit.primID);
  if (material.plain) return;
  if (material.culled && facing(ray, hit) > 0) {
    arguments->valid[0] = 0;
    return;
  }
  if (!material.cut && !material.transmits) return;
  auto& context = *reinterpret_cast<ShadowContext*>(arguments->context);
  context.transmittance *= transmittance_of(posed, material, ray, hit, context);
  if (max_component(context.transmittance) > 1e-5f) arguments->valid[0] = 0;
}

Shadow ShadowContext::result(float length, const glm::vec3& absorption) const {
  Shadow shadow{transmittance, crossed_glass};
  const glm::vec3 rest = absorption + inside;
  glm::vec3 optical = depth;
  if (max_component(glm::abs(rest)) > 1e-6f && std::isfinite(length)) optical += rest * length;
  if (!is_black(optical)) shadow.transmittance *= glm::exp(-glm::max(optical, glm::vec3(0)));
  return shadow;
}

}  // namespace vitrine::trace
