// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/lights.h"

#include "host/trace/warp.h"

namespace vitrine::trace {
namespace {

// A textured emitter's mean luminance over the triangle, from a fixed pattern of points.
float mean_emission(const PosedObject& posed, const ShadingMaterial& material, int triangle) {
  constexpr int kSteps = 4;
  float sum = 0;
  for (int i = 0; i < kSteps * kSteps; ++i) {
    const glm::vec2 u((static_cast<float>(i % kSteps) + 0.5f) / kSteps, (static_cast<float>(i / kSteps) + 0.5f) / kSteps);
    const glm::vec2 b = uniform_triangle(u);
    sum += luminance(covered_emission_at(*posed.textures, material, posed.point_at(triangle, b.x, b.y)));
  }
  return sum / (kSteps * kSteps);
}

// KHR_lights_punctual: the recommended windowed inverse square.
float range_window(float distance, float range) {
  return range > 0 ? std::clamp(1 - sqr(sqr(distance / range)), 0.0f, 1.0f) : 1.0f;
}

}  // namespace

Lights::Lights(const World& world) : world_(&world), environment_(world.scene().environment) {
  std::vector<float> powers;
  add_emitters(world, powers);
  add_punctual(world, powers);
  if (environment_.sampled()) {
    environment_index_ = static_cast<int>(powers.size());
    powers.push_back(environment_.mean_luminance() * 4 * kPi * kPi * sqr(world.radius()));
  }
  for (const float p : powers) total_power_ += p;
  choice_ = AliasTable(powers);
  if (choice_.empty()) environment_index_ = -1;
}

void Lights::add_emitters(const World& world, std::vector<float>& powers) {
  emitter_of_triangle_.resize(world.objects().size());
  for (size_t o = 0; o < world.objects().size(); ++o) {
    const PosedObject& posed = world.objects()[o];
    if (posed.object->follows_camera || posed.emission <= 0) continue;
    const Geometry& g = *posed.geometry;
    const size_t triangles = g.indices.size() / 3;
    for (size_t t = 0; t < triangles; ++t) {
      const ShadingMaterial& material = posed.material(t);
      if (!material.emits) continue;
      const auto corner = [&](size_t k) {
        return glm::vec3(posed.world_from_object * glm::vec4(g.positions[g.indices[3 * t + k]], 1));
      };
      Emitter e{};
      e.corner = corner(0);
      e.edge1 = corner(1) - e.corner;
      e.edge2 = corner(2) - e.corner;
      const glm::vec3 cross = glm::cross(e.edge1, e.edge2);
      const float length = glm::length(cross);
      e.area = 0.5f * length;
      e.textured = material.source->emissive_texture || material.cut;
      e.double_sided = material.source->double_sided;
      const float mean = e.textured ? mean_emission(posed, material, static_cast<int>(t)) : luminance(material.source->emissive);
      const float power = posed.emission * mean * e.area * kPi * (e.double_sided ? 2.0f : 1.0f);
      if (!(power > 0) || !std::isfinite(power)) continue;
      e.normal = cross * (posed.orientation / length);
      e.radiance = posed.emission * material.source->emissive;
      e.object = static_cast<int>(o);
      e.triangle = static_cast<int>(t);
      auto& map = emitter_of_triangle_[o];
      if (map.empty()) map.assign(triangles, -1);
      map[t] = static_cast<int>(emitters_.size());
      emitters_.push_back(e);
      powers.push_back(power);
    }
  }
}

void Lights::add_punctual(const World& world, std::vector<float>& powers) {
  const Scene& scene = world.scene();
  const Pose& pose = world.current_pose();
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    const float factor = i < pose.light_emission.size() ? pose.light_emission[i] : 1.0f;
    const float strength = factor * luminance(light.intensity);
    if (!(strength > 0)) continue;
    const glm::mat4& m = pose.world_from_node[static_cast<size_t>(light.node)];
    const glm::vec3 axis = -glm::vec3(m[2]);
    Punctual p{};
    p.kind = light.kind;
    p.position = glm::vec3(m[3]);
    p.direction = glm::length(axis) > 0 ? glm::normalize(axis) : glm::vec3(0, 0, -1);
    p.intensity = factor * light.intensity;
    p.range = light.range;
    p.cone_scale = 1 / std::max(0.001f, std::cos(light.inner_cone) - std::cos(light.outer_cone));
    p.cone_offset = -std::cos(light.outer_cone) * p.cone_scale;
    punctual_.push_back(p);
    const float cone = 2 * kPi * (1 - std::cos(light.outer_cone));
    powers.push_back(strength * (light.kind == LightKind::kDirectional ? kPi * sqr(world.radius())
                                 : light.kind == LightKind::kSpot      ? cone
                                                                       : 4 * kPi));
  }
}

bool Lights::sample(const glm::vec3& from, float pick, const glm::vec2& u, LightSample& sample) const {
  const int index = choice_.sample(pick);
  const float probability = choice_.probability(index);
  const auto emitters = static_cast<int>(emitters_.size());
  sample = {};
  if (index == environment_index_) {
    sample.wi = environment_.sample(pick, u, sample.pdf);
    sample.distance = std::numeric_limits<float>::infinity();
    sample.radiance = environment_.radiance(sample.wi);
  } else if (index < emitters) {
    if (!sample_emitter(emitters_[static_cast<size_t>(index)], from, u, sample)) return false;
  } else {
    if (!sample_punctual(punctual_[static_cast<size_t>(index - emitters)], from, sample)) return false;
  }
  sample.pdf *= probability;
  return sample.pdf > 0 && !is_black(sample.radiance);
}

bool Lights::sample_emitter(const Emitter& e, const glm::vec3& from, const glm::vec2& u, LightSample& sample) const {
  const glm::vec2 b = uniform_triangle(u);
  const glm::vec3 offset = e.corner + b.x * e.edge1 + b.y * e.edge2 - from;
  const float distance2 = glm::dot(offset, offset);
  if (!(distance2 > 0)) return false;
  sample.distance = std::sqrt(distance2);
  sample.wi = offset / sample.distance;
  const float cosine = -glm::dot(sample.wi, e.normal);
  if (cosine <= 0 && !e.double_sided) return false;
  sample.pdf = distance2 / std::max(std::fabs(cosine) * e.area, 1e-20f);
  sample.radiance = e.radiance;
  if (e.textured) {
    const PosedObject& posed = world_->objects()[static_cast<size_t>(e.object)];
    sample.radiance = posed.emission * covered_emission_at(*posed.textures, posed.material(static_cast<size_t>(e.triangle)),
                                                           posed.point_at(e.triangle, b.x, b.y));
  }
  return true;
}

bool Lights::sample_punctual(const Punctual& light, const glm::vec3& from, LightSample& sample) {
  sample.punctual = true;
  sample.pdf = 1;
  if (light.kind == LightKind::kDirectional) {
    sample.wi = -light.direction;
    sample.distance = std::numeric_limits<float>::infinity();
    sample.radiance = light.intensity;
    return true;
  }
  const glm::vec3 offset = light.position - from;
  const float distance2 = glm::dot(offset, offset);
  if (!(distance2 > 0)) return false;
  sample.distance = std::sqrt(distance2);
  sample.wi = offset / sample.distance;
  float scale = range_window(sample.distance, light.range) / distance2;
  if (light.kind == LightKind::kSpot) {
    const float cone = std::clamp(-glm::dot(light.direction, sample.wi) * light.cone_scale + light.cone_offset, 0.0f, 1.0f);
    scale *= cone * cone;
  }
  sample.radiance = light.intensity * scale;
  return true;
}

float Lights::surface_pdf(const Surface& surface, const glm::vec3& direction, float distance) const {
  const auto& map = emitter_of_triangle_[static_cast<size_t>(surface.object)];
  const int index = map.empty() ? -1 : map[static_cast<size_t>(surface.triangle)];
  if (index < 0) return 0;
  const float cosine = std::fabs(glm::dot(direction, surface.geometric));
  const float area = emitters_[static_cast<size_t>(index)].area;
  return choice_.probability(index) * distance * distance / std::max(cosine * area, 1e-20f);
}

float Lights::environment_pdf(const glm::vec3& direction) const {
  if (environment_index_ < 0) return 0;
  return choice_.probability(environment_index_) * environment_.pdf(direction);
}

}  // namespace vitrine::trace
