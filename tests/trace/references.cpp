// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Pictures by an independent renderer, as the tracer renders them: whole, and the marked regions.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "host/scene/environment.h"
#include "host/scene/files.h"
#include "host/trace/camera_rays.h"
#include "host/trace/tracer.h"
#include "tests/trace/facet_walk.h"
#include "tests/trace/measure.h"

namespace vitrine::test {
namespace {

constexpr double kRegionSlack = 0.02;   // relative, of a region's mean luminance, beyond chance
constexpr double kPictureSlack = 0.03;  // relative root mean square of the whole picture, beyond what noise explains
constexpr uint32_t kSeeds = 4;
constexpr int kSamples = 12;  // of a pixel and seed

struct Box {
  int x, y, width, height;
};

// What stays beyond the slack follows rules that are known.
//
// Two are of the scene, and the tracer is given the same scene (as_the_reference_has_it() below). The lamp is black from behind
// there, while glTF lets light from behind pass it. And the glass slab stands in the plane of the floor: which of two surfaces in
// one place light meets is for neither renderer to say, and the reference loses what leaves through the slab's bottom.
//
// One is of very rough metals: light that facets scatter more than once comes out nearly diffusely here (Kulla & Conty 2017),
// while the reference follows it from facet to facet (Heitz et al. 2016), which sends it elsewhere. There the tracer is first
// held to the reference with that one rule exchanged on the object that the region shows, and then to itself within what the
// exchange was seen to do.
//
// The last is the reference's own: its two ways to find a lamp disagree. Sampled directions towards a near lamp come from an
// approximate arc cosine, and those that miss are dropped: up to 1.2 % of the light beside a lamp is lost (so the wall right
// below one keeps 0.5 % less in all rooms). What rough glass sends to sampled lamps is 2 % less than what its scattered rays find
// there. So for what rough glass lights, the same program was run again on the same scenes with the lamp left to be found by
// scattering alone (the material's setting "Multiple Importance" off), which needs neither rule; `rerun` has these means.
struct Rerun {
  double luminance, error;  // standard error of four seeds
};
struct ReferenceCase {
  const char* name;
  std::set<std::string> walked;  // regions for which the rule of metals counts
  std::map<std::string, Rerun> rerun;
};
void PrintTo(const ReferenceCase& c, std::ostream* out) { *out << c.name; }
class Reference : public testing::TestWithParam<ReferenceCase> {};

trace::PathSettings with_caustics() {
  trace::PathSettings settings;
  settings.straight_shadows = false;
  return settings;
}

// Luminance over the box's pixels.
using PixelRadiance = std::function<glm::vec3(int x, int y, trace::Sampler& sampler, std::mt19937& random)>;
Estimate mean_over(const Box& box, int trials, int samples, const PixelRadiance& radiance) {
  return estimate(trials, [&](uint32_t seed) {
    std::mt19937 random(seed);
    double sum = 0;
    for (int y = box.y; y < box.y + box.height; ++y)
      for (int x = box.x; x < box.x + box.width; ++x)
        for (int s = 0; s < samples; ++s) {
          trace::Sampler sampler(static_cast<uint32_t>(x), static_cast<uint32_t>(y), static_cast<uint32_t>(s), seed);
          sum += trace::luminance(radiance(x, y, sampler, random));
        }
    return sum / (box.width * box.height * samples);
  });
}

// The tracer, but for one object on which light walks from facet to facet.
class WalkedRegion {
 public:
  WalkedRegion(const Scene& scene, int width, int height)
      : laboratory_(scene, with_caustics()), camera_(scene.camera, world().current_pose().world_from_camera, width, height) {}

  Estimate luminance(const Box& box, int trials, int samples) const {
    trace::Hit hit;
    EXPECT_TRUE(world().intersect(centre_ray(box.x + box.width / 2, box.y + box.height / 2), hit));
    return mean_over(box, trials, samples, [&](int x, int y, trace::Sampler& sampler, std::mt19937& random) {
      return radiance(centre_ray(x, y), hit.object, sampler, random);
    });
  }

 private:
  const trace::World& world() const { return *laboratory_.world; }
  trace::Ray centre_ray(int x, int y) const { return camera_.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f); }

  glm::vec3 radiance(trace::Ray ray, int object, trace::Sampler& sampler, std::mt19937& random) const {
    glm::vec3 throughput(1);
    for (int bounce = 0; bounce < 64; ++bounce) {
      trace::Hit hit;
      if (!world().intersect(ray, hit) || hit.object != object) return throughput * laboratory_.integrator.incoming(ray, sampler);
      const trace::Surface s = world().surface_at(ray, hit);
      const trace::SurfaceParameters p = trace::parameters_at(
          world().textures(), *s.material, s.point, glm::vec3(trace::base_color_at(world().textures(), *s.material, s.point)));
      if (s.back) throughput *= glm::exp(-s.material->absorption * hit.distance);
      const trace::Basis basis(s.back ? -s.shading : s.shading);
      const float eta = !s.material->transmits ? 0 : s.back ? 1 / p.ior : p.ior;
      const glm::vec3 local = FacetWalk(p.alpha, eta).sample(basis.to_local(-ray.direction), random);
      if (local.z < 0) throughput *= p.glass_tint;
      ray.direction = basis.to_world(local);
      ray.origin = s.position + s.geometric * (glm::dot(s.geometric, ray.direction) < 0 ? -s.margin : s.margin);
    }
    return glm::vec3(0);
  }

  Laboratory laboratory_;
  trace::CameraRays camera_;
};

// A black sheet that faces up, `height` above all faces of the object that look down.
void add_black_sheet(Scene& scene, const std::string& name, float height) {
  Material black;
  black.base_color = {0, 0, 0, 1};
  black.metallic = black.specular = 0;
  const auto material = static_cast<int>(scene.materials.size());
  scene.materials.push_back(black);
  Object sheet = *std::find_if(scene.objects.begin(), scene.objects.end(), [&](const Object& o) { return o.name == name; });
  sheet.name += "-sheet";
  Geometry& g = sheet.geometry;
  const std::vector<uint32_t> all = std::exchange(g.indices, {});
  for (size_t i = 0; i < all.size(); i += 3)
    if (g.normals[all[i]].y < -0.5f) g.indices.insert(g.indices.end(), {all[i], all[i + 2], all[i + 1]});
  g.triangle_materials.assign(g.indices.size() / 3, material);
  for (glm::vec3& p : g.positions) p.y += height;
  for (glm::vec3& n : g.normals) n = -n;
  scene.objects.push_back(sheet);
}

void lift(Scene& scene, const std::string& name, float height) {
  for (Object& o : scene.objects)
    if (o.name == name)
      for (glm::vec3& p : o.geometry.positions) p.y += height;
}

bool has_slab(const Scene& scene) {
  return std::any_of(scene.objects.begin(), scene.objects.end(), [](const Object& o) { return o.name == "slab"; });
}

void as_the_reference_has_it(Scene& scene) {
  constexpr float kMillimetre = 1e-3f;
  add_black_sheet(scene, "lamp", kMillimetre);
  if (!has_slab(scene)) return;
  lift(scene, "slab", kMillimetre);
  add_black_sheet(scene, "slab", -kMillimetre / 2);
}

// Cropped means of 2 x 2 pixels: the renderers' pixel filters differ at edges.
std::vector<double> halved_luminance(const std::vector<glm::vec3>& radiance, int width, int height) {
  std::vector<double> result;
  for (int y = 0; y + 1 < height; y += 2)
    for (int x = 0; x + 1 < width; x += 2) {
      const auto at = [&](int i, int j) {
        return static_cast<double>(trace::luminance(radiance[static_cast<size_t>(j * width + i)]));
      };
      result.push_back((at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)) / 4);
    }
  return result;
}

struct Renderings {
  std::vector<std::vector<glm::vec3>> pictures;  // one a seed
  std::vector<glm::vec3> mean;
};
Renderings render(const Scene& scene, int width, int height) {
  TraceOptions options;
  options.width = width;
  options.height = height;
  options.samples_per_pixel = kSamples;
  options.layers = false;
  Tracer tracer(scene);
  Renderings r;
  r.mean.assign(static_cast<size_t>(width) * static_cast<size_t>(height), glm::vec3(0));
  for (options.seed = 1; options.seed <= kSeeds; ++options.seed) {
    r.pictures.push_back(tracer.render({}, options).combined);
    for (size_t i = 0; i < r.mean.size(); ++i) r.mean[i] += r.pictures.back()[i] / static_cast<float>(kSeeds);
  }
  return r;
}

Estimate luminance_of(const Renderings& r, const Box& box, int width) {
  return estimate(kSeeds, [&](uint32_t seed) {
    double sum = 0;
    for (int y = box.y; y < box.y + box.height; ++y)
      for (int x = box.x; x < box.x + box.width; ++x)
        sum += trace::luminance(r.pictures[seed - 1][static_cast<size_t>(y * width + x)]);
    return sum / (box.width * box.height);
  });
}

// Its mean squared difference is noise of both and what the renderers see differently. Ours is measured between seeds; the
// reference, with 8 times the samples or more, has at most as much.
void expect_same_picture(const Renderings& r, const Environment& truth) {
  const auto a = halved_luminance(r.mean, truth.width, truth.height),
             b = halved_luminance(truth.radiance, truth.width, truth.height);
  double noise = 0, difference = 0, square = 0;
  for (const auto& p : r.pictures) {
    const auto own = halved_luminance(p, truth.width, truth.height);
    for (size_t i = 0; i < own.size(); ++i) noise += (own[i] - a[i]) * (own[i] - a[i]) / (kSeeds * (kSeeds - 1));
  }
  for (size_t i = 0; i < a.size(); ++i) {
    difference += (a[i] - b[i]) * (a[i] - b[i]);
    square += b[i] * b[i];
  }
  const double relative = std::sqrt(difference / square), explained = std::sqrt(2 * noise / square);
  EXPECT_LT(relative, explained + kPictureSlack);
  std::printf("  the picture: relative RMSE %.4f, noise explains %.4f\n", relative, explained);
}

TEST_P(Reference, AgreesWithAnIndependentRenderer) {
  const std::string stem = std::string(VITRINE_EXTRA_ASSETS) + "/reference/" + GetParam().name;
  std::ifstream file(stem + ".json");
  if (!file) GTEST_SKIP() << "no reference pictures at " << stem;
  const auto json = nlohmann::json::parse(file);
  const auto scene = load_scene(stem + ".toml");
  scene->settings.caustics = true;  // as the reference has them
  as_the_reference_has_it(*scene);
  const Environment truth = decode_exr(read_file(stem + ".exr", 1 << 28));
  const Renderings renderings = render(*scene, truth.width, truth.height);

  for (const auto& [name, box_json] : json["regions"].items()) {
    SCOPED_TRACE(name);
    const Box box{box_json[0], box_json[1], box_json[2], box_json[3]};
    const Estimate ours = luminance_of(renderings, box, truth.width);
    const double told = trace::luminance({json["mean"][name][0], json["mean"][name][1], json["mean"][name][2]});
    const auto rerun = GetParam().rerun.find(name);
    const bool again = rerun != GetParam().rerun.end();
    const double expected = again ? rerun->second.luminance : told, chance = again ? 3 * rerun->second.error : 0;
    std::printf("  %-12s %+.2f %% +- %.2f %%", name.c_str(), 100 * (ours.mean / told - 1), 100 * ours.error / told);
    if (again) std::printf(", of the reference run again %+.2f %%", 100 * (ours.mean / expected - 1));
    double exchange = 0;
    if (GetParam().walked.count(name)) {
      const Estimate walked = WalkedRegion(*scene, truth.width, truth.height).luminance(box, 8, 32);
      std::printf(", from facet to facet %+.2f %% +- %.2f %%", 100 * (walked.mean / expected - 1), 100 * walked.error / expected);
      EXPECT_NEAR(walked.mean, expected, kRegionSlack * expected + 3 * walked.error);
      exchange = std::fabs(walked.mean - ours.mean);
    }
    std::printf("\n");
    EXPECT_NEAR(ours.mean, expected, kRegionSlack * expected + 3 * ours.error + chance + exchange);
  }
  expect_same_picture(renderings, truth);
}

// Three things that may come of light that leaves a slab through a bottom in the plane of the floor. Only when it is lost does
// the wall behind keep within the slack of what the reference shows.
TEST(ReferenceRules, WhatLeavesTheSlabThroughTheFloorIsLost) {
  const std::string stem = std::string(VITRINE_EXTRA_ASSETS) + "/reference/glass";
  std::ifstream file(stem + ".json");
  if (!file) GTEST_SKIP() << "no reference pictures at " << stem;
  const auto json = nlohmann::json::parse(file);
  const auto& mean = json["mean"]["back_high"];
  const auto& corner = json["regions"]["back_high"];
  const double expected = trace::luminance({mean[0], mean[1], mean[2]});
  const auto excess = [&](const std::function<void(Scene&)>& change) {
    const auto scene = load_scene(stem + ".toml");
    change(*scene);
    const Laboratory laboratory(*scene, with_caustics());
    const trace::CameraRays camera(scene->camera, laboratory.world->current_pose().world_from_camera, 256, 256);
    Estimate e =
        mean_over({corner[0], corner[1], corner[2], corner[3]}, 8, 64, [&](int x, int y, trace::Sampler& sampler, std::mt19937&) {
          sampler.start_vertex(0, 0);
          const trace::Ray ray = camera.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
          const trace::CameraSample c = laboratory.integrator.trace(ray, sampler);
          return c.diffuse + c.view + c.specular;
        });
    e.mean = e.mean / expected - 1;
    e.error /= expected;
    std::printf("  %+.2f %% +- %.2f %%\n", 100 * e.mean, 100 * e.error);
    return e;
  };
  const Estimate lost = excess(as_the_reference_has_it);
  const Estimate reaches_the_floor = excess([](Scene& scene) {
    add_black_sheet(scene, "lamp", 1e-3f);
    lift(scene, "slab", 1e-3f);
  });
  const Estimate stays_inside = excess([](Scene& scene) { lift(scene, "slab", -1e-3f); });
  EXPECT_LT(lost.mean + 3 * lost.error, kRegionSlack);
  EXPECT_GT(reaches_the_floor.mean - 3 * reaches_the_floor.error, kRegionSlack);
  // The reference's program, given the slab lifted as much, and lamps that are found by scattering alone.
  constexpr Rerun kLifted{0.47276, 0.00013};
  EXPECT_NEAR(reaches_the_floor.mean, kLifted.luminance / expected - 1,
              3 * std::hypot(reaches_the_floor.error, kLifted.error / expected));
  EXPECT_GT(stays_inside.mean - 3 * stays_inside.error, kRegionSlack);
}

const std::map<std::string, Rerun> kRoughGlassLights = {{"frost", {0.29706, 0.00017}},
                                                        {"amber", {0.07349, 0.00006}},
                                                        {"floor_front", {0.22969, 0.00015}},
                                                        {"back_high", {0.45639, 0.00021}}};

INSTANTIATE_TEST_SUITE_P(All, Reference,
                         testing::Values(ReferenceCase{"cornell", {}, {}},
                                         ReferenceCase{"metals", {"ball2", "ball3", "ball4"}, {}}, ReferenceCase{"glass", {}, {}},
                                         ReferenceCase{"amber_frost", {}, kRoughGlassLights}),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

}  // namespace
}  // namespace vitrine::test
