// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/integrator.h"

namespace vitrine::trace {
namespace {

constexpr int kMaxScatterings = 64;
constexpr int kMaxVertices = 256;   // with surfaces that are passed through
constexpr int kCandidates = 4;      // at the first vertex, whose noise is seen most; one later
constexpr int kRouletteFrom = 2;    // scatterings after which paths may end early
constexpr float kRouletteGain = 4;  // they do so below a quarter of their light: the best noise for time in a lit room
constexpr int kSpecularPaths = 2;   // into the specular lobe of the first hit, per camera ray; twice as many where it dominates
constexpr float kFaintSpecular = 0.02f,
                kStrongSpecular = 0.5f;  // its albedo below which one path is enough; above which it dominates
// Glass reflects little, but what it reflects may be a lamp: of several paths from one point at least this share goes each way.
constexpr float kLeastChance = 0.25f;
// The cone of a scattered ray is as wide as this share of a round solid angle that holds its density's direction once.
constexpr float kConeShare = 0.25f;
constexpr float kReach = 1 - 4e-6f;      // of the way to a light that has to be free: all but the rounding of its length
constexpr float kStraightAlpha = 0.25f;  // lobes this wide take light straight through glass

float power_heuristic(float a, float b) {
  const float a2 = a * a, b2 = b * b;
  return a2 > 0 ? a2 / (a2 + b2) : 0.0f;
}

// A ray may start this far on the side of `direction`.
glm::vec3 leave(const Surface& s, const glm::vec3& direction) {
  return s.position + s.geometric * (glm::dot(s.geometric, direction) < 0 ? -s.margin : s.margin);
}

// Whether light that passes the surface's glass changes direction.
bool bends(const ShadingMaterial& m) { return m.solid || !m.smooth; }

// Whether wi points into the solid that the surface bounds. Lights are not sampled there: from inside, refraction decides.
bool points_inside(const Bsdf& bsdf, const glm::vec3& wi) { return bsdf.solid() && bsdf.same_side(wi) == bsdf.inside(); }

// What lights are sampled for: a thin pane is lit from both sides, all else from one.
LightReceiver receiver_at(const Surface& s, const Bsdf& bsdf) {
  if (s.material->transmits && !bsdf.solid()) return {s.position, glm::vec3(0)};
  return {s.position, bsdf.inside() ? -bsdf.normal() : bsdf.normal()};
}

Bsdf make_bsdf(const World& world, const Surface& s, const glm::vec4& base_color, const glm::vec3& wo) {
  const SurfaceParameters p = parameters_at(world.textures(), *s.material, s.point, glm::vec3(base_color));
  return Bsdf(p, wo, s.geometric, s.shading, s.coat);
}

glm::vec2 rotated(const glm::vec2& u, int j) {  // the R2 sequence of Roberts 2018
  const glm::vec2 v = u + static_cast<float>(j) * glm::vec2(0.7548777f, 0.5698403f);
  return v - glm::floor(v);
}

bool survives_roulette(Path& path, float probability, float u) {
  if (probability >= 1) return true;
  if (u >= probability) return false;
  path.throughput /= probability;
  return true;
}

// What is lost in the medium of the segment that ended at `surface`.
void absorb(Path& path, const Surface& surface, float distance) {
  const bool unknown_inside = path.media.empty() && surface.back && surface.material->solid;
  const glm::vec3 absorption = unknown_inside ? surface.material->absorption : path.media.absorption();
  if (!is_black(absorption)) path.throughput *= glm::exp(-absorption * distance);
}

glm::vec3 bounded(const glm::vec3& light, float bound) {
  const float peak = max_component(light);
  return bound > 0 && peak > bound ? light * (bound / peak) : light;
}

}  // namespace

struct Integrator::Candidate {
  LightSample light;
  BsdfValue value;
};

Integrator::Integrator(const World& world, const Lights& lights, const PathSettings& settings)
    : world_(world),
      lights_(lights),
      settings_(settings),
      sample_lights_(!lights.empty() && settings.strategy != LightStrategy::kScatteringOnly) {}

glm::vec3 Integrator::backdrop(const glm::vec3& direction) const {
  const Scene& scene = world_.scene();
  const bool painted = world_.backdrop() >= 0 && !scene.background_is_environment;
  return painted ? scene.background_color : lights_.environment().radiance(direction);
}

FirstHit Integrator::meet(const Ray& camera_ray) const {
  FirstHit first;
  first.ray = camera_ray;
  first.solid = world_.intersect(camera_ray, first.hit);
  if (first.solid) first.surface = world_.surface_at(camera_ray, first.hit);
  first.object = first.solid ? first.surface.object : world_.backdrop();
  return first;
}

CameraSample Integrator::shade(const FirstHit& first, LayerSet layers, Sampler& sampler) const {
  CameraSample result;
  result.object = first.object;
  result.layers = layers;
  if (!first.solid) {
    result.diffuse = backdrop(first.ray.direction);
    return result;
  }
  const Surface& surface = first.surface;
  Path path;
  path.ray = first.ray;
  absorb(path, surface, first.hit.distance);
  sampler.start_vertex(0, path.vertex++);
  if (advance_through_cut(surface, first.hit, path, sampler)) {
    if (layers.specular) result.specular = follow(path, sampler);
    return result;
  }
  const glm::vec4 base = base_color_at(world_.textures(), *surface.material, surface.point);
  if (surface.material->source->unlit) {
    result.diffuse = glm::vec3(base);
    return result;
  }

  // Split: both lobes share one light sample, then each goes its own way.
  const Bsdf bsdf = make_bsdf(world_, surface, base, -first.ray.direction);
  const Lobes lobes = !layers.specular ? Lobes::kDiffuse : !layers.diffuse ? Lobes::kSpecular : Lobes::kAll;
  const Direct direct = sample_lights(path, surface, bsdf, {true, lobes}, sampler);
  if (layers.diffuse) {
    glm::vec3 scattered = direct.diffuse;
    if (bsdf.has_diffuse()) {
      Path own = path;
      own.stream = 1;
      sampler.start_vertex(own.stream, 0);
      if (scatter(own, surface, bsdf, Continuation::kDiffuse, sampler)) scattered += follow(own, sampler);
    }
    const LayeredEmission emission = world_.layered_emission_of(surface);
    result.diffuse = emission.diffuse + scattered;
    result.view = emission.view + scattered * (bsdf.view_factor() - 1.0f);
  }
  if (layers.specular) {
    result.specular = direct.specular;
    if (bsdf.has_specular()) result.specular += trace_specular(path, surface, bsdf, sampler);
  }
  return result;
}

// Reflections and refractions change with every view, so each frame owes its own paths to them; what is diffuse is averaged
// over all views when textures are inferred.
glm::vec3 Integrator::trace_specular(const Path& start, const Surface& surface, const Bsdf& bsdf, Sampler& sampler) const {
  const float albedo = bsdf.specular_albedo();
  const int paths = albedo < kFaintSpecular ? 1 : albedo < kStrongSpecular ? kSpecularPaths : 2 * kSpecularPaths;
  const float chance = std::clamp(albedo / kFaintSpecular, 0.1f, 1.0f);
  glm::vec3 sum(0);
  for (int i = 0; i < paths; ++i) {
    Path path = start;
    path.stream = 2 + static_cast<uint32_t>(i);
    sampler.start_vertex(path.stream, 0);
    const Stratum stratum{i, paths};
    if (survives_roulette(path, chance, sampler.get1d()) &&
        scatter(path, surface, bsdf, Continuation::kSpecular, sampler, stratum)) {
      sum += follow(path, sampler);
    }
  }
  return sum / static_cast<float>(paths);
}

glm::vec3 Integrator::incoming(const Ray& ray, Sampler& sampler) const {
  Path path;
  path.ray = ray;
  path.scatterings = 1;
  path.vertex = 2;
  return follow(path, sampler);
}

glm::vec3 Integrator::follow(Path& path, Sampler& sampler) const {
  glm::vec3 direct(0), indirect(0);
  const auto add = [&](const glm::vec3& light, bool is_direct) { (is_direct ? direct : indirect) += path.throughput * light; };
  for (; path.vertex < kMaxVertices; ++path.vertex) {
    // Find the next surface, or the environment.
    Hit hit;
    if (!world_.intersect(path.ray, hit)) {
      add(escaped(path), path.scatterings <= 1);
      break;
    }
    const Surface surface = world_.surface_at(path.ray, hit);
    absorb(path, surface, hit.distance);
    sampler.start_vertex(path.stream, path.vertex);
    if (advance_through_cut(surface, hit, path, sampler)) continue;

    // Light that the surface gives by itself.
    path.travelled += hit.distance;
    const glm::vec4 base = base_color_at(world_.textures(), *surface.material, surface.point);
    if (surface.material->source->unlit) {
      if (path.seen) add(glm::vec3(base), true);
      break;
    }
    if (surface.material->emits) add(emitted(path, surface), path.scatterings <= 1);
    if (path.scatterings >= kMaxScatterings) break;

    // Light that it scatters, from lights directly and from wherever the path goes on.
    const Bsdf bsdf = make_bsdf(world_, surface, base, -path.ray.direction);
    const Direct sampled = sample_lights(path, surface, bsdf, {false, Lobes::kAll}, sampler);
    add(sampled.diffuse + sampled.specular, path.scatterings == 0);
    if (!scatter(path, surface, bsdf, Continuation::kEither, sampler)) break;
    if (path.scatterings < kRouletteFrom) continue;
    if (!survives_roulette(path, kRouletteGain * max_component(path.throughput) * path.radiance_scale, sampler.get1d())) break;
  }
  return direct + bounded(indirect, settings_.max_radiance);
}

bool Integrator::advance_through_cut(const Surface& surface, const Hit& hit, Path& path, Sampler& sampler) const {
  if (!surface.material->cut) return false;
  const float alpha = alpha_at(*surface.material, base_color_at(world_.textures(), *surface.material, surface.point));
  if (sampler.get1d() < alpha) return false;
  path.ray.width = path.ray.width_at(hit.distance);
  path.ray.origin = leave(surface, path.ray.direction);
  path.ray.t_min = 0;
  path.travelled += hit.distance;
  return true;
}

// The weight of light that a scattered ray found, whose source sample_lights() would have found with `light_pdf`; negative:
// never.
glm::vec3 Integrator::found_weight(const Path& path, float light_pdf) const {
  if (!sample_lights_ || light_pdf < 0) return glm::vec3(1);
  if (!path.lights_sampled) return path.share;
  if (settings_.strategy == LightStrategy::kLightsOnly) return glm::vec3(0);
  return path.share * power_heuristic(path.pdf, light_pdf);
}

glm::vec3 Integrator::emitted(const Path& path, const Surface& surface) const {
  const glm::vec3 emission = world_.emission_of(surface);
  if (is_black(emission)) return emission;
  return emission * found_weight(path, lights_.surface_pdf(path.receiver, surface, path.ray.direction, path.travelled));
}

glm::vec3 Integrator::escaped(const Path& path) const {
  if (path.in_sight) return backdrop(path.ray.direction);
  const glm::vec3 radiance = lights_.environment().radiance(path.ray.direction);
  if (!lights_.environment_sampled()) return radiance;
  return radiance * found_weight(path, lights_.environment_pdf(path.receiver, path.ray.direction));
}

// Whether light that a wide lobe receives may come straight through glass. Not to what stands inside of glass, which is a lens to
// it: refracted rays find that light.
bool Integrator::goes_straight(const Path& path) const { return settings_.straight_shadows && path.media.empty(); }

// From beside the surface to just before the light: nothing but the rounding of numbers is left out, or a cover close to a lamp
// would leak.
Ray Integrator::ray_to_light(const Surface& surface, const LightSample& light) const {
  const glm::vec3 origin = leave(surface, light.wi);
  if (!std::isfinite(light.distance)) return {origin, light.wi};
  const glm::vec3 way = surface.position + light.distance * light.wi - origin;
  const float length = glm::length(way);
  return {origin, way / length, 0, std::max(length * kReach - lights_.margin(), 0.0f)};
}

// A point of a light that the surface can see where nothing is in the way.
bool Integrator::draw(const Path& path, const Bsdf& bsdf, const Lights::View& view, const LightChoice& choice, float pick,
                      const glm::vec2& point, Candidate& c) const {
  if (!lights_.sample(view, pick, point, c.light) || points_inside(bsdf, c.light.wi)) return false;
  c.value = bsdf.evaluate(c.light.wi, choice.lobes);
  if (!choice.split) c.value.diffuse *= bsdf.view_factor();
  if (!bsdf.same_side(c.light.wi)) c.value.specular *= path.share * path.share_behind_glass;
  return !is_black(c.value.diffuse) || !is_black(c.value.specular);
}

// Of several candidates one, in proportion to what it would give if nothing were in the way; `scale` makes up for the choice.
bool Integrator::draw_best(const Path& path, const Bsdf& bsdf, const Lights::View& view, const LightChoice& choice, float pick,
                           const glm::vec2& point, float u, Candidate& kept, float& scale) const {
  float sum = 0, kept_target = 0;
  for (int j = 0; j < kCandidates; ++j) {
    Candidate c;
    const float stratum = std::min((pick + static_cast<float>(j)) / kCandidates, 0x1.fffffep-1f);
    if (!draw(path, bsdf, view, choice, stratum, rotated(point, j), c)) continue;
    const Direct light = weigh(c, bsdf, choice.split);
    const float target = luminance(light.diffuse + light.specular);
    if (!(target > 0)) continue;
    sum += target;
    const float chance = target / sum;
    if (u < chance) {
      kept = c;
      kept_target = target;
      u /= chance;
    } else {
      u = (u - chance) / (1 - chance);
    }
  }
  scale = sum > 0 ? sum / (kCandidates * kept_target) : 0;
  return sum > 0;
}

Integrator::Direct Integrator::sample_lights(const Path& path, const Surface& surface, const Bsdf& bsdf,
                                             const LightChoice& choice, Sampler& sampler) const {
  if (!sample_lights_ || !bsdf.has_density()) return {};
  const float pick = sampler.get1d();
  const glm::vec2 point = sampler.get2d();
  const Lights::View view = lights_.view(receiver_at(surface, bsdf));
  Candidate c;
  float scale = 1;
  const bool drawn = choice.split && !lights_.single()
                         ? draw_best(path, bsdf, view, choice, pick, point, sampler.get1d(), c, scale)
                         : draw(path, bsdf, view, choice, pick, point, c);
  if (!drawn) return {};

  const bool straight = c.light.punctual ? settings_.straight_shadows
                                         : goes_straight(path) && (!is_black(c.value.diffuse) || bsdf.wide(kStraightAlpha));
  const Shadow shadow = world_.shadow(ray_to_light(surface, c.light), straight, path.media.absorption());
  if (is_black(shadow.transmittance)) return {};
  if (shadow.through_glass) scale *= path.radiance_scale;  // inside of glass radiance is larger by its squared index
  const Direct light = shadow.through_glass ? weigh_through_glass(c, bsdf) : weigh(c, bsdf, choice.split);
  return {light.diffuse * (scale * shadow.transmittance), light.specular * (scale * shadow.transmittance)};
}

Integrator::Direct Integrator::weigh(const Candidate& c, const Bsdf& bsdf, bool split) const {
  const glm::vec3 light = c.light.radiance / c.light.pdf;
  if (c.light.punctual || settings_.strategy == LightStrategy::kLightsOnly)
    return {c.value.diffuse * light, c.value.specular * light};
  float diffuse_pdf = c.value.diffuse_pdf, specular_pdf = c.value.specular_pdf;
  if (!split) {
    const float p = bsdf.diffuse_probability();
    diffuse_pdf = specular_pdf = p * diffuse_pdf + (1 - p) * specular_pdf;
  }
  return {c.value.diffuse * light * power_heuristic(c.light.pdf, diffuse_pdf),
          c.value.specular * light * power_heuristic(c.light.pdf, specular_pdf)};
}

Integrator::Direct Integrator::weigh_through_glass(const Candidate& c, const Bsdf& bsdf) const {
  const glm::vec3 light = c.light.radiance / c.light.pdf;
  const bool all = c.light.punctual || bsdf.wide(kStraightAlpha);  // no scattered ray could find a punctual light
  return {c.value.diffuse * light, all ? c.value.specular * light : glm::vec3(0)};
}

bool Integrator::scatter(Path& path, const Surface& surface, const Bsdf& bsdf, Continuation continuation, Sampler& sampler,
                         const Stratum& stratum) const {
  const glm::vec2 u = sampler.get2d();
  float diffuse_chance = continuation == Continuation::kDiffuse ? 1.0f : 0.0f;
  if (continuation == Continuation::kEither) {
    if (!bsdf.has_diffuse() && !bsdf.has_specular()) return false;
    diffuse_chance = bsdf.diffuse_probability();
  }
  float lobe = 0;
  if (diffuse_chance < 1)
    lobe = std::min((static_cast<float>(stratum.index) + sampler.get1d()) / static_cast<float>(stratum.count), 0x1.fffffep-1f);
  BsdfSample sample;
  if (diffuse_chance == 1 || lobe < diffuse_chance) {
    if (!bsdf.sample_diffuse(u, sample)) return false;
  } else {
    lobe = std::min((lobe - diffuse_chance) / (1 - diffuse_chance), 0x1.fffffep-1f);
    if (!bsdf.sample_specular(lobe, u, sample, stratum.count > 1 ? kLeastChance : 0.0f)) return false;
  }

  BsdfValue value;
  float pdf = 0;
  if (sample.delta) {
    path.throughput *= sample.weight / (1 - diffuse_chance);
  } else {
    value = bsdf.evaluate(sample.wi, diffuse_chance == 1   ? Lobes::kDiffuse
                                     : diffuse_chance == 0 ? Lobes::kSpecular
                                                           : Lobes::kAll);
    if (continuation == Continuation::kEither) value.diffuse *= bsdf.view_factor();
    pdf = diffuse_chance * value.diffuse_pdf + (1 - diffuse_chance) * value.specular_pdf;
    if (!(pdf > 0)) return false;
    path.throughput *= (value.diffuse + value.specular) / pdf;
  }
  if (!(max_component(path.throughput) > 0)) return false;
  continue_path(path, surface, bsdf, sample, value, pdf);
  return true;
}

void Integrator::continue_path(Path& path, const Surface& surface, const Bsdf& bsdf, const BsdfSample& sample,
                               const BsdfValue& value, float pdf) const {
  const float width = path.ray.width_at(surface.distance);
  const float spread = sample.delta ? path.ray.spread : std::max(path.ray.spread, kConeShare * std::sqrt(kInvPi / pdf));
  path.ray = {leave(surface, sample.wi), sample.wi, 0, std::numeric_limits<float>::infinity(), width, spread};
  ++path.scatterings;
  const bool bent = sample.transmitted && bends(*surface.material);
  if (sample.transmitted && !bent) return;  // straight on through a pane: lights were sampled through it, too

  path.in_sight = false;
  path.travelled = 0;
  path.pdf = pdf;
  path.receiver = receiver_at(surface, bsdf);
  path.lights_sampled = sample_lights_ && !sample.delta && !points_inside(bsdf, sample.wi);
  path.seen = path.seen && sample.delta;
  if (bent) {
    path.share *= path.share_behind_glass;
    path.share_behind_glass = glm::vec3(1);
  } else if (sample.total && bsdf.inside()) {
    // Where glass reflects all, straight lines go out instead, with the light that this path would find.
  } else {
    path.share = glm::vec3(1);
    path.share_behind_glass = glm::vec3(1);
    if (path.lights_sampled && goes_straight(path)) {
      const bool none = is_black(value.specular) || bsdf.wide(kStraightAlpha);
      path.share_behind_glass =
          none ? glm::vec3(0) : value.specular / glm::max(value.diffuse + value.specular, glm::vec3(1e-20f));
    }
  }
  if (!bent || !bsdf.solid()) return;
  const float ior = surface.material->ior;
  if (bsdf.inside()) {
    path.media.leave(surface.object);
    path.radiance_scale /= ior * ior;
  } else {
    path.media.enter(surface.object, surface.material->absorption);
    path.radiance_scale *= ior * ior;
  }
}

}  // namespace vitrine::trace
