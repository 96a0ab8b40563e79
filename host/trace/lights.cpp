// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/lights.h"

#include "host/trace/warp.h"

namespace vitrine::trace {
namespace {

constexpr float kLeastShare = 0.05f;  // of what has a place, directional lights and the environment, each that gives light

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

LightBounds bounds_of(const glm::vec3& corner, const glm::vec3& edge1, const glm::vec3& edge2, const glm::vec3& normal,
                      float intensity, float area, bool double_sided) {
  LightBounds b;
  b.low = glm::min(corner, glm::min(corner + edge1, corner + edge2));
  b.high = glm::max(corner, glm::max(corner + edge1, corner + edge2));
  b.axis = normal;
  b.intensity = intensity;
  b.area = area;
  b.double_sided = double_sided;
  return b;
}

// A point lights all directions; a spot all within its inner cone, and less from there to its outer.
LightBounds bounds_of(const Light& light, const glm::vec3& position, const glm::vec3& direction, float intensity) {
  constexpr float kRounding = 1e-3f;  // radians that a cone is widened by
  LightBounds b;
  b.low = b.high = position;
  b.axis = direction;
  b.intensity = intensity;
  const bool spot = light.kind == LightKind::kSpot;
  b.cos_normals = spot ? std::cos(light.inner_cone) : -1.0f;
  b.cos_emission = spot ? std::cos(std::max(light.outer_cone - light.inner_cone, 0.0f) + kRounding) : 0.0f;
  return b;
}

// The irradiance from `wi` that a receiver counts on.
float received(float irradiance, const glm::vec3& wi, const LightReceiver& receiver) {
  if (is_black(receiver.normal)) return irradiance;
  const float cosine = glm::dot(receiver.normal, wi);
  return cosine > 0 ? irradiance * std::max(cosine, kLeastReceivedCosine) : 0.0f;
}

// KHR_lights_punctual: the recommended windowed inverse square.
float range_window(float distance, float range) {
  return range > 0 ? std::clamp(1 - sqr(sqr(distance / range)), 0.0f, 1.0f) : 1.0f;
}

}  // namespace

Lights::Lights(const World& world) : world_(&world), environment_(world.scene().environment) {
  std::vector<LightBounds> bounds;
  add_emitters(world, bounds);
  add_punctual(world, bounds);
  tree_ = LightTree(bounds);
  count_ = bounds.size() + directional_.size() + (environment_.sampled() ? 1 : 0);
}

void Lights::add_emitters(const World& world, std::vector<LightBounds>& bounds) {
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
      const float area = 0.5f * length;
      e.textured = material.source->emissive_texture || material.cut;
      e.coated = material.coated;
      e.double_sided = material.source->double_sided;
      const float mean = e.textured ? mean_emission(posed, material, static_cast<int>(t)) : luminance(material.source->emissive);
      const float intensity = posed.emission * mean * area;
      if (!(intensity > 0) || !std::isfinite(intensity)) continue;
      e.front = posed.orientation * cross;
      const glm::vec3 radiance = posed.emission * material.source->emissive;
      if (radiances_.empty() || radiances_.back() != radiance) radiances_.push_back(radiance);
      e.radiance = static_cast<int32_t>(radiances_.size()) - 1;
      e.object = static_cast<int>(o);
      e.triangle = static_cast<int>(t);
      auto& map = emitter_of_triangle_[o];
      if (map.empty()) map.assign(triangles, -1);
      map[t] = static_cast<int>(emitters_.size());
      emitters_.push_back(e);
      margin_ = std::max(margin_, posed.triangles[t].margin);
      bounds.push_back(bounds_of(e.corner, e.edge1, e.edge2, e.front / length, intensity, area, e.double_sided));
    }
  }
}

void Lights::add_punctual(const World& world, std::vector<LightBounds>& bounds) {
  const Scene& scene = world.scene();
  const Pose& pose = world.current_pose();
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    const float factor = i < pose.light_emission.size() ? pose.light_emission[i] : 1.0f;
    const float strength = factor * luminance(light.intensity);
    if (!(strength > 0) || !std::isfinite(strength)) continue;
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
    if (p.kind == LightKind::kDirectional) {
      directional_.push_back(p);
      continue;
    }
    punctual_.push_back(p);
    bounds.push_back(bounds_of(light, p.position, p.direction, strength));
  }
}

float Lights::directional_irradiance(const LightReceiver& receiver) const {
  float sum = 0;
  for (const Punctual& light : directional_) sum += received(luminance(light.intensity), -light.direction, receiver);
  return sum;
}

// In proportion to irradiance without shadows; but the environment's samples come from all around, and half of them are for
// receivers that face the other way, so it counts twice. What gives light at all keeps a share: a lamp may be hidden where the
// sky is not. (Shares by power would give almost all samples to the sky wherever the scene is large and the lamp small.)
Lights::Shares Lights::shares(const LightTree::View& view) const {
  const float tree = tree_.irradiance(view), directional = directional_irradiance(view.receiver);
  const float environment = environment_.sampled() ? 2 * kPi * environment_.mean_luminance() : 0.0f;
  const float sum = tree + directional + environment;
  if (!(sum > 0)) return {0, 0, 0};
  const float parts = (tree > 0 ? 1.0f : 0.0f) + (directional > 0 ? 1.0f : 0.0f) + (environment > 0 ? 1.0f : 0.0f);
  const auto share = [&](float part) { return part > 0 ? kLeastShare + (1 - parts * kLeastShare) * (part / sum) : 0.0f; };
  return {share(tree), share(directional), share(environment)};
}

bool Lights::sample(const View& view, float pick, const glm::vec2& u, LightSample& sample) const {
  sample = {};
  const Shares& s = view.shares;
  float probability;
  if (pick < s.tree) {
    probability = s.tree;
    const float rest = s.tree < 1 ? std::min(pick / s.tree, kBeforeOne) : pick;  // mostly 1, and divisions take long
    if (!sample_placed(view.tree, rest, u, sample)) return false;
  } else if (pick -= s.tree; pick < s.directional || !(s.environment > 0)) {
    probability = s.directional;
    if (!sample_directional(view.receiver(), std::min(pick / s.directional, kBeforeOne), sample)) return false;
  } else {
    probability = s.environment;
    sample.wi = environment_.sample(std::min((pick - s.directional) / s.environment, kBeforeOne), u, sample.pdf);
    sample.distance = std::numeric_limits<float>::infinity();
    sample.radiance = environment_.radiance(sample.wi);
  }
  sample.pdf *= probability;
  return sample.pdf > 0 && !is_black(sample.radiance);
}

bool Lights::sample_placed(const LightTree::View& view, float pick, const glm::vec2& u, LightSample& sample) const {
  float probability;
  const int light = tree_.sample(view, pick, probability);
  if (light < 0) return false;
  const glm::vec3& from = view.receiver.position;
  const auto index = static_cast<size_t>(light);
  const bool lit = index < emitters_.size() ? sample_emitter(emitters_[index], from, u, sample)
                                            : sample_punctual(punctual_[index - emitters_.size()], from, sample);
  sample.pdf *= probability;
  return lit;
}

bool Lights::sample_directional(const LightReceiver& receiver, float pick, LightSample& sample) const {
  const float sum = directional_irradiance(receiver);
  float rest = pick * sum;
  for (const Punctual& light : directional_) {
    const float part = received(luminance(light.intensity), -light.direction, receiver);
    if (rest >= part) {
      rest -= part;
      continue;
    }
    sample.wi = -light.direction;
    sample.distance = std::numeric_limits<float>::infinity();
    sample.radiance = light.intensity;
    sample.pdf = part / sum;
    sample.punctual = true;
    return true;
  }
  return false;  // rounding left a rest
}

bool Lights::sample_emitter(const Emitter& e, const glm::vec3& from, const glm::vec2& u, LightSample& sample) const {
  const glm::vec2 b = uniform_triangle(u);
  const glm::vec3 offset = e.corner + b.x * e.edge1 + b.y * e.edge2 - from;
  const float distance2 = glm::dot(offset, offset);
  if (!(distance2 > 0)) return false;
  sample.distance = std::sqrt(distance2);
  sample.wi = offset / sample.distance;
  const float seen = -0.5f * glm::dot(sample.wi, e.front);  // area times cosine
  if (seen <= 0 && !e.double_sided) return false;
  sample.pdf = distance2 / std::max(std::fabs(seen), 1e-20f);
  sample.radiance = radiances_[static_cast<size_t>(e.radiance)];
  if (!e.textured && !e.coated) return true;
  const PosedObject& posed = world_->objects()[static_cast<size_t>(e.object)];
  const ShadingMaterial& material = posed.material(static_cast<size_t>(e.triangle));
  const SurfacePoint point = posed.point_at(e.triangle, b.x, b.y);
  if (e.textured) sample.radiance = posed.emission * covered_emission_at(*posed.textures, material, point);
  if (e.coated) {
    const float cosine = std::fabs(glm::dot(sample.wi, e.front)) / glm::length(e.front);
    sample.radiance *= coat_share_at(*posed.textures, material, point, cosine).seen;
  }
  return true;
}

bool Lights::sample_punctual(const Punctual& light, const glm::vec3& from, LightSample& sample) {
  sample.punctual = true;
  sample.pdf = 1;
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

float Lights::surface_pdf(const LightReceiver& receiver, const Surface& surface, const glm::vec3& direction,
                          float distance) const {
  const auto& map = emitter_of_triangle_[static_cast<size_t>(surface.object)];
  const int index = map.empty() ? -1 : map[static_cast<size_t>(surface.triangle)];
  if (index < 0) return -1;
  const float cosine = std::fabs(glm::dot(direction, surface.geometric));
  const float area = 0.5f * glm::length(emitters_[static_cast<size_t>(index)].front);
  const View seen = view(receiver);
  const float probability = seen.shares.tree * tree_.probability(seen.tree, index);
  return probability * distance * distance / std::max(cosine * area, 1e-20f);
}

float Lights::environment_pdf(const LightReceiver& receiver, const glm::vec3& direction) const {
  if (!environment_.sampled()) return 0;
  return view(receiver).shares.environment * environment_.pdf(direction);
}

}  // namespace vitrine::trace
