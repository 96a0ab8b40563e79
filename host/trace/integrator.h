// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Path tracing from the camera with next-event estimation and multiple importance sampling (Veach 1997, power heuristic).
//
// Layers. The first surface that a camera ray meets decides the object. There the path splits: one continues by the diffuse
// lobe and fills `diffuse` (with the surface's emission), one by all other lobes and fills `specular`. Later vertices draw one
// lobe at random. What lies behind a cut-out or blended first surface belongs to that surface's `specular`. So does what the
// view takes from diffuse light or adds to it (Bsdf::view_factor() - 1 times `diffuse`, which is the same from everywhere):
// `specular` may be negative.
//
// Textures are filtered over the cone that a ray stands for (Ray::width): half a pixel wide at the camera, after a scattering as
// wide as a fraction of the lobe. THIS IS A BIAS, a small one: the mean over a part of what the lobe would average.
//
// Lights. The first vertex draws four candidate points of lights (later ones draw one), keeps one by its unshadowed contribution
// (resampling, Talbot et al. 2005; the MIS weights are inside, so the estimate stays unbiased) and sends one shadow ray.
//
// Glass in the way of a shadow ray. For diffuse and rough lobes (alpha >= 1/4) light goes straight through, losing Fresnel
// reflection, tint and absorption on its way ("straight-through shadows"); the refracted paths that such lobes start are then
// not counted again, nor is what glass reflects totally within on their way. What stands inside of glass finds its light by
// refraction. THIS IS A BIAS: light about keeps its total but is not focused, there are no caustics of mesh and punctual lights
// through glass. Lobes narrower than that see true refraction, and a constant environment is never sampled as a light, so its
// light is refracted truly. Reflections keep their caustics, which a small lamp may make noisy; Settings::max_radiance bounds
// what one path may bring beyond direct light (a bias too; off by default).
#pragma once

#include "host/trace/lights.h"
#include "host/trace/path.h"
#include "host/trace/sampler.h"

namespace vitrine::trace {

enum class LightStrategy : uint8_t { kBoth, kLightsOnly, kScatteringOnly };

struct PathSettings {
  float max_radiance = 0;                         // of one path's indirect light; 0: unbounded
  LightStrategy strategy = LightStrategy::kBoth;  // other values are for tests
  bool straight_shadows = true;                   // false: true caustics, noisy, and none from punctual lights
};

// What a camera ray meets first.
struct FirstHit {
  Ray ray;
  Hit hit;
  int object = -1;   // index into Scene::objects, or -1 where nothing is met; the backdrop is an object without a surface
  bool solid = false;  // there is a surface
  Surface surface;
};

// The layers of the picture that a camera sample is asked for, and gives.
struct LayerSet {
  bool diffuse = true, specular = true;
};

// Radiance along one camera ray.
struct CameraSample {
  int object = -1;
  LayerSet layers;      // those that were asked for; the others are 0
  glm::vec3 diffuse{0};
  glm::vec3 view{0};    // what the view adds to `diffuse` or takes from it; part of the layer `specular`
  glm::vec3 specular{0};
};

class Integrator {
 public:
  Integrator(const World& world, const Lights& lights, const PathSettings& settings);
  FirstHit meet(const Ray& camera_ray) const;
  // Draws from sampler vertex 1 on; vertex 0 is the camera's.
  CameraSample shade(const FirstHit& first, LayerSet layers, Sampler& sampler) const;
  CameraSample trace(const Ray& camera_ray, Sampler& sampler) const { return shade(meet(camera_ray), {}, sampler); }
  // What comes from where a ray goes that was scattered before: a path's rest, for benchmarks.
  glm::vec3 incoming(const Ray& ray, Sampler& sampler) const;

 private:
  struct Direct {
    glm::vec3 diffuse{0}, specular{0};
  };
  struct Candidate;
  struct Stratum {
    int index, count;
  };
  enum class Continuation : uint8_t { kDiffuse, kSpecular, kEither };

  glm::vec3 backdrop(const glm::vec3& direction) const;
  glm::vec3 trace_specular(const Path& start, const Surface& surface, const Bsdf& bsdf, Sampler& sampler) const;
  glm::vec3 follow(Path& path, Sampler& sampler) const;
  bool advance_through_cut(const Surface& surface, const Hit& hit, Path& path, Sampler& sampler) const;
  glm::vec3 emitted(const Path& path, const Surface& surface) const;
  glm::vec3 escaped(const Path& path) const;
  glm::vec3 found_weight(const Path& path, float light_pdf) const;
  bool goes_straight(const Path& path) const;
  Ray ray_to_light(const Surface& surface, const LightSample& light) const;
  struct LightChoice {
    bool split;   // lobes are kept apart, as at the first vertex
    Lobes lobes;  // that light is wanted for
  };
  bool draw(const Path& path, const Bsdf& bsdf, const Lights::View& view, const LightChoice& choice, float pick,
            const glm::vec2& point, Candidate& candidate) const;
  bool draw_best(const Path& path, const Bsdf& bsdf, const Lights::View& view, const LightChoice& choice, float pick,
                 const glm::vec2& point, float u, Candidate& kept, float& scale) const;
  Direct sample_lights(const Path& path, const Surface& surface, const Bsdf& bsdf, const LightChoice& choice,
                       Sampler& sampler) const;
  Direct weigh(const Candidate& candidate, const Bsdf& bsdf, bool split) const;
  Direct weigh_through_glass(const Candidate& candidate, const Bsdf& bsdf) const;
  // `stratum`: of the numbers that choose a lobe, where several paths go on from one point.
  bool scatter(Path& path, const Surface& surface, const Bsdf& bsdf, Continuation continuation, Sampler& sampler,
               const Stratum& stratum = {0, 1}) const;
  void continue_path(Path& path, const Surface& surface, const Bsdf& bsdf, const BsdfSample& sample, const BsdfValue& value,
                     float pdf) const;

  const World& world_;
  const Lights& lights_;
  PathSettings settings_;
  bool sample_lights_;
};

}  // namespace vitrine::trace
