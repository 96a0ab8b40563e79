// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Which light a point asks: what the tree says it does is what it does, and it does it well.
#include <gtest/gtest.h>

#include <array>
#include <numeric>
#include <random>

#include "host/trace/light_tree.h"
#include "tests/trace/measure.h"
#include "tests/trace/scenes.h"

namespace vitrine::test {
namespace {

using trace::LightBounds;
using trace::LightReceiver;
using trace::LightSample;
using trace::LightTree;

float uniform(std::mt19937& random) { return static_cast<float>(random() >> 8) * 0x1p-24f; }
glm::vec3 point_in_box(std::mt19937& random, float half) {
  const float x = uniform(random), y = uniform(random), z = uniform(random);
  return half * (2.0f * glm::vec3(x, y, z) - 1.0f);
}
glm::vec3 direction(std::mt19937& random) {
  for (;;) {
    const glm::vec3 p = point_in_box(random, 1);
    const float length = glm::length(p);
    if (length > 0.1f && length < 1) return p / length;
  }
}

LightBounds point_light(const glm::vec3& position, float intensity) {
  LightBounds b;
  b.low = b.high = position;
  b.cos_normals = -1;
  b.intensity = intensity;
  return b;
}

// One-sided and double-sided triangles, points and spots, of intensities over four orders of magnitude.
std::vector<LightBounds> mixed_lights(int count, uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<LightBounds> lights;
  for (int i = 0; i < count; ++i) {
    LightBounds b = point_light(point_in_box(random, 5), std::pow(10.0f, 4 * uniform(random) - 2));
    if (i % 4 < 2) {
      const glm::vec3 u = 0.2f * direction(random), v = 0.2f * direction(random), cross = glm::cross(u, v);
      b.high = b.low + glm::max(glm::vec3(0), glm::max(u, v));
      b.low += glm::min(glm::vec3(0), glm::min(u, v));
      b.axis = glm::normalize(cross);
      b.cos_normals = 1;
      b.area = 0.5f * glm::length(cross);
      b.double_sided = i % 4 == 1;
    } else if (i % 4 == 3) {
      b.axis = direction(random);
      b.cos_normals = 0.9f;
      b.cos_emission = 0.8f;
    }
    lights.push_back(b);
  }
  return lights;
}

LightReceiver receiver(std::mt19937& random, bool all_around) {
  const glm::vec3 position = point_in_box(random, 6);
  return {position, all_around ? glm::vec3(0) : direction(random)};
}

double sum_of_probabilities(const LightTree& tree, const LightReceiver& at, size_t lights) {
  double sum = 0;
  const LightTree::View view = tree.view(at);
  for (size_t i = 0; i < lights; ++i) sum += tree.probability(view, static_cast<int>(i));
  return sum;
}

TEST(LightSelection, ProbabilitiesOfAllLightsSumToOneFromEverywhere) {
  auto lights = mixed_lights(300, 1);
  for (LightBounds& l : lights) l.cos_normals = -1;  // every cluster's bound is then met by some light in it
  const LightTree tree(lights);
  std::mt19937 random(2);
  for (int i = 0; i < 500; ++i) {
    EXPECT_NEAR(sum_of_probabilities(tree, {point_in_box(random, 6), glm::vec3(0)}, lights.size()), 1, 1e-5);
  }
}

// A cluster may turn out to hold nothing that reaches the point: then no light is chosen, as often as the sum lacks of one.
TEST(LightSelection, LightsAreChosenAsOftenAsStated) {
  const auto lights = mixed_lights(120, 3);
  const LightTree tree(lights);
  std::mt19937 random(4);
  constexpr int kDraws = 100000, kReceivers = 12;
  for (int i = 0; i < kReceivers; ++i) {
    const LightTree::View view = tree.view(receiver(random, i % 2));
    std::vector<double> counts(lights.size() + 1), expected(counts.size());
    for (size_t k = 0; k < lights.size(); ++k) expected[k] = kDraws * tree.probability(view, static_cast<int>(k));
    expected.back() = kDraws - std::accumulate(expected.begin(), expected.end(), 0.0);
    ASSERT_GT(expected.back(), -1e-5 * kDraws);
    for (int d = 0; d < kDraws; ++d) {
      float probability;
      const int light = tree.sample(view, uniform(random), probability);
      ++counts[light < 0 ? lights.size() : static_cast<size_t>(light)];
      if (light < 0) continue;
      ASSERT_GT(probability, 0);
      ASSERT_NEAR(probability, tree.probability(view, light), 1e-5 * probability);
    }
    EXPECT_GT(goodness_of_fit(counts, expected), 0.01 / kReceivers) << "receiver " << i;
  }
}

// A triangle gives light to every point in front of it, a spot within its cone: then they may be chosen.
TEST(LightSelection, NoLightThatReachesAPointIsLeftOut) {
  const auto lights = mixed_lights(400, 5);
  const LightTree tree(lights);
  std::mt19937 random(6);
  int reached = 0;
  for (int i = 0; i < 300; ++i) {
    const LightReceiver at = receiver(random, i % 2);
    const LightTree::View view = tree.view(at);
    for (size_t k = 0; k < lights.size(); ++k) {
      const LightBounds& l = lights[k];
      const glm::vec3 wi = glm::normalize(0.5f * (l.low + l.high) - at.position);
      float cosine = -glm::dot(wi, l.axis);
      if (l.double_sided) cosine = std::fabs(cosine);
      const float edge = std::cos(std::acos(l.cos_normals) + std::acos(l.cos_emission));
      if ((l.cos_normals > -1 && cosine <= edge + 1e-4f) || (i % 2 == 0 && glm::dot(wi, at.normal) <= 1e-4f)) continue;
      ++reached;
      EXPECT_GT(tree.probability(view, static_cast<int>(k)), 0) << "light " << k;
    }
  }
  EXPECT_GT(reached, 10000);
}

TEST(LightSelection, DependsOnTheLightsAndNotOnTheirAddresses) {
  const auto lights = mixed_lights(500, 7);
  const auto copy = std::make_unique<std::vector<LightBounds>>(lights);
  const LightTree a(lights), b(*copy);
  std::mt19937 random(8);
  for (int i = 0; i < 1000; ++i) {
    const LightReceiver at = receiver(random, false);
    const float u = uniform(random);
    float p = 0, q = 0;
    ASSERT_EQ(a.sample(a.view(at), u, p), b.sample(b.view(at), u, q));
    ASSERT_EQ(p, q);
  }
}

TEST(LightSelection, NoLightOrASingleOneIsNoSpecialCase) {
  float probability = 0;
  EXPECT_EQ(LightTree().sample({}, 0.5f, probability), -1);
  const std::vector<LightBounds> one = {point_light({1, 2, 3}, 1e-20f)};
  const LightTree tree(one);
  EXPECT_EQ(tree.sample(tree.view({{0, 0, 0}, {0, 1, 0}}), 0.5f, probability), 0);
  EXPECT_EQ(probability, 1);
  const Scene dark = scene_with_camera({0, 0, 3}, {0, 0, 0}, 0.5f);
  const Laboratory laboratory(dark);
  LightSample sample;
  EXPECT_TRUE(laboratory.lights.empty());
  EXPECT_FALSE(laboratory.lights.sample(laboratory.lights.view({}), 0.5f, {0.5f, 0.5f}, sample));
}

// Coincident lights, lights at the receiver, rows whose spacing halves, and numbers near the ends of a float.
TEST(LightSelection, ExtremeLightsGiveNeitherNansNorLostProbability) {
  std::vector<std::vector<LightBounds>> cases(4);
  for (int i = 0; i < 1000; ++i) cases[0].push_back(point_light({1, 1, 1}, 1));
  for (int i = 0; i < 120; ++i) cases[1].push_back(point_light({std::ldexp(1.0f, -i), 0, 0}, std::ldexp(1.0f, i % 60)));
  for (int i = 0; i < 20; ++i) cases[2].push_back(point_light({i, 0, 0}, i % 2 ? 3e38f : 1e-37f));
  for (int i = 0; i < 20; ++i) cases[3].push_back(point_light({1e-12f * static_cast<float>(i), 0, 0}, 1));
  for (const auto& lights : cases) {
    const LightTree tree(lights);
    for (const glm::vec3& position : {glm::vec3(1, 1, 1), glm::vec3(0), glm::vec3(1, 0, 0), glm::vec3(0, 1e9f, 0)}) {
      const LightReceiver at{position, glm::vec3(0)};
      EXPECT_NEAR(sum_of_probabilities(tree, at, lights.size()), 1, 1e-4);
      for (const float u : {0.0f, 0.3f, 0x1.fffffep-1f}) {
        float probability = 0;
        ASSERT_GE(tree.sample(tree.view(at), u, probability), 0);
        EXPECT_TRUE(probability > 0 && probability <= 1.0001f);
      }
      EXPECT_TRUE(std::isfinite(tree.irradiance(tree.view(at))));
    }
  }
}

TEST(LightSelection, LampsThatFaceAwayAreNeverChosenWhereOthersLight) {
  Scene scene = scene_with_camera({0, 2, 3}, {0, 0, 0}, 0.5f);
  const int glow = add_material(scene, lamp(glm::vec3(1))), glare = add_material(scene, lamp(glm::vec3(1000)));
  add_object(scene, make_quad({2, 2, 0}, {0.1f, 0, 0}, {0, 0, 0.1f}), glow, "down");
  for (int i = 0; i < 40; ++i) {
    const float x = 0.3f * static_cast<float>(i);
    add_object(scene, make_quad({x, 1, 0}, {0, 0, 0.1f}, {0.1f, 0, 0}), glare, "up");
    add_object(scene, make_quad({x, -1, 0}, {0, 0, 0.1f}, {0.1f, 0, 0}), glare, "under the floor");
  }
  const Laboratory laboratory(scene);
  const auto view = laboratory.lights.view({glm::vec3(0), {0, 1, 0}});
  std::mt19937 random(1);
  int lit = 0;
  for (int i = 0; i < 2000; ++i) {
    LightSample sample;
    const glm::vec2 u(uniform(random), uniform(random));
    if (!laboratory.lights.sample(view, uniform(random), u, sample)) continue;
    ++lit;
    ASSERT_EQ(sample.radiance.x, 1);
  }
  EXPECT_GT(lit, 1800);  // the rest chose a cluster that turned out to hold none that lights the point
}

TEST(LightSelection, TheFarSideOfABallLampIsSeldomAsked) {
  Scene scene = scene_with_camera({0, 2, 3}, {0, 0, 0}, 0.5f);
  add_object(scene, make_sphere({1, 2, 0}, 0.2f, 24), add_material(scene, lamp(glm::vec3(1))), "ball");
  const Laboratory laboratory(scene);
  std::mt19937 random(1);
  int lit = 0;
  for (int i = 0; i < 2000; ++i) {
    LightSample sample;
    const glm::vec3 position = glm::vec3(1, 2, 0) + (0.5f + 3 * uniform(random)) * direction(random);
    const float pick = uniform(random);
    lit += laboratory.lights.sample(laboratory.lights.view({position, glm::vec3(0)}), pick, {0.5f, 0.5f}, sample);
  }
  EXPECT_GT(3 * lit, 2 * 2000);  // by power alone it is less than a half
}

// All kinds of lights in one room.
Scene room_of_all_lights() {
  Scene scene = scene_with_camera({0, 2, 3}, {0, 0, 0}, 0.5f);
  add_object(scene, make_sphere({1, 2, 0}, 0.2f, 24), add_material(scene, lamp(glm::vec3(10))), "ball");
  Material screen = lamp(glm::vec3(4));
  screen.double_sided = true;
  screen.emissive_texture.image = 0;
  scene.images.push_back({"stripes", 2, 1, {255, 255, 255, 255, 90, 90, 90, 255}});
  add_object(scene, make_quad({-2, 0.2f, -1}, {0, 1, 0}, {0.3f, 0, 1}), add_material(scene, screen), "screen");
  Geometry degenerate = make_quad({0, 1, 0}, {0.1f, 0, 0}, {0.2f, 0, 0});
  degenerate.normals.assign(degenerate.normals.size(), glm::vec3(0, 1, 0));
  add_object(scene, degenerate, add_material(scene, lamp(glm::vec3(5))), "line");
  Light light;
  light.intensity = glm::vec3(2);
  add_light(scene, light, {0, 2, 1}, {0, -1, 0});
  light.kind = LightKind::kSpot;
  add_light(scene, light, {1, 2, 1}, {0, -1, 0});
  light.kind = LightKind::kDirectional;
  add_light(scene, light, {0, 9, 0}, {0.6f, -0.8f, 0});
  scene.environment.width = 16;
  scene.environment.height = 8;
  for (int i = 0; i < 16 * 8; ++i) scene.environment.radiance.push_back(glm::vec3(0.1f * static_cast<float>(i % 7)));
  return scene;
}

TEST(LightSelection, ScatteredRaysStateTheDensityThatSamplingHas) {
  const Scene scene = room_of_all_lights();
  const Laboratory laboratory(scene);
  const trace::Lights& lights = laboratory.lights;
  std::mt19937 random(9);
  int emitters = 0, sky = 0, punctual = 0, differ = 0;
  const auto compare = [&](float stated, float sampled) { differ += !(std::fabs(stated - sampled) <= 2e-3f * sampled); };
  for (int i = 0; i < 20000; ++i) {
    const glm::vec3 position = point_in_box(random, 2) + glm::vec3(0, 1.1f, 0);
    const LightReceiver at{position, i % 3 ? direction(random) : glm::vec3(0)};
    LightSample sample;
    const float pick = uniform(random);
    const glm::vec2 u(uniform(random), uniform(random));
    if (!lights.sample(lights.view(at), pick, u, sample)) continue;
    ASSERT_TRUE(sample.pdf > 0 && std::isfinite(sample.pdf));
    if (sample.punctual) {
      ++punctual;
    } else if (!std::isfinite(sample.distance)) {
      ++sky;
      compare(lights.environment_pdf(at, sample.wi), sample.pdf);
    } else {
      trace::Hit hit;
      const trace::Ray ray{position, sample.wi, 0.999f * sample.distance};
      if (!laboratory.world->intersect(ray, hit) || hit.distance > 1.001f * sample.distance) continue;  // past an edge
      const trace::Surface surface = laboratory.world->surface_at(ray, hit);
      if (std::fabs(glm::dot(surface.geometric, sample.wi)) < 0.05f) continue;  // the cosine is what is left of rounding
      ++emitters;
      compare(lights.surface_pdf(at, surface, sample.wi, hit.distance), sample.pdf);
    }
  }
  EXPECT_GT(emitters, 500);
  EXPECT_GT(sky, 500);
  EXPECT_GT(punctual, 500);
  EXPECT_LT(differ, (emitters + sky) / 100);  // where rounding moves a direction to the next triangle or cell
}

TEST(LightSelection, LampsThatThePoseSwitchesOffAreNotChosen) {
  Scene scene = scene_with_camera({0, 2, 3}, {0, 0, 0}, 0.5f);
  const int near = add_object(scene, make_quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}), add_material(scene, lamp(glm::vec3(9))), "near");
  add_object(scene, make_quad({0, 5, 0}, {1, 0, 0}, {0, 0, 1}), add_material(scene, lamp(glm::vec3(1))), "far");
  Axis axis;
  axis.name = "switch";
  axis.shape.kind = AxisKind::kDiscrete;
  axis.shape.samples = 2;
  scene.axes.push_back(axis);
  scene.objects[static_cast<size_t>(near)].emission_axis = 0;
  scene.objects[static_cast<size_t>(near)].emission_of_value = {1, 0};
  trace::World world(scene);
  for (const float value : {0.0f, 1.0f}) {
    Position position;
    position[0] = value;
    world.pose(position);
    const trace::Lights lights(world);
    const auto view = lights.view({glm::vec3(0.5f, 0, 0.5f), {0, 1, 0}});
    float brightest = 0, faintest = 10;
    for (int i = 0; i < 200; ++i) {
      LightSample sample;
      ASSERT_TRUE(lights.sample(view, (static_cast<float>(i) + 0.5f) / 200, {0.5f, 0.5f}, sample));
      brightest = std::max(brightest, sample.radiance.x);
      faintest = std::min(faintest, sample.radiance.x);
    }
    EXPECT_EQ(brightest, value > 0 ? 1 : 9);
    EXPECT_EQ(faintest, 1);
  }
}

// Lambert's formula: irradiance from a polygon of radiance 1 wholly above the horizon of n, its front towards the point.
double polygon_irradiance(const std::array<glm::dvec3, 4>& corners, const glm::dvec3& at, const glm::dvec3& n) {
  glm::dvec3 sum(0);
  for (size_t i = 0; i < 4; ++i) {
    const glm::dvec3 a = glm::normalize(corners[i] - at), b = glm::normalize(corners[(i + 1) % 4] - at);
    const glm::dvec3 cross = glm::cross(a, b);
    sum += glm::normalize(cross) * std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0));
  }
  return std::fabs(0.5 * glm::dot(sum, n));
}

// A thousand lamps above a floor; the one above the origin is a hundredth as strong as the others and matters more than any.
struct ManyLamps {
  static constexpr float kSide = 0.1f;  // metres
  Scene scene = scene_with_camera({0, 2, 3}, {0, 0, 0}, 0.5f);
  std::vector<glm::vec3> corners;
  std::vector<float> radiances;
  double irradiance = 0;  // at the origin, normal +Y

  ManyLamps() {
    std::mt19937 random(11);
    for (int i = 0; i < 1000; ++i) {
      const glm::vec3 far(0.3f * static_cast<float>(i % 40) + 3, 2 + uniform(random), 0.6f * static_cast<float>(i / 40) - 7);
      const glm::vec3 corner = i == 0 ? glm::vec3(-0.05f, 0.25f, -0.05f) : far;
      const float radiance = i == 0 ? 0.5f : 30 + 40 * uniform(random);
      corners.push_back(corner);
      radiances.push_back(radiance);
      add_object(scene, make_quad(corner, {kSide, 0, 0}, {0, 0, kSide}), add_material(scene, lamp(glm::vec3(radiance))), "lamp");
      const glm::dvec3 c(corner), x(kSide, 0, 0), z(0, 0, kSide);
      irradiance += radiance * polygon_irradiance({c, c + x, c + x + z, c + z}, glm::dvec3(0), {0, 1, 0});
    }
  }
};

// Variance of the estimate that chooses lamps by power and points of them evenly, without noise: from points on a grid.
double variance_by_power(const ManyLamps& lamps) {
  constexpr int kGrid = 8;
  double all = 0, squares = 0;
  for (const float r : lamps.radiances) all += r;
  for (size_t i = 0; i < lamps.corners.size(); ++i) {
    for (int k = 0; k < kGrid * kGrid; ++k) {
      const glm::vec3 u((static_cast<float>(k % kGrid) + 0.5f) / kGrid, 0, (static_cast<float>(k / kGrid) + 0.5f) / kGrid);
      const glm::dvec3 point(lamps.corners[i] + ManyLamps::kSide * u);
      const double d2 = glm::dot(point, point), probability = lamps.radiances[i] / all;
      const double value = lamps.radiances[i] * ManyLamps::kSide * ManyLamps::kSide * point.y * point.y / (d2 * d2);
      squares += value * value / (probability * kGrid * kGrid);
    }
  }
  return squares - lamps.irradiance * lamps.irradiance;
}

TEST(LightSelection, NearWeakLampsOutweighFarStrongOnes) {
  const ManyLamps lamps;
  const Laboratory laboratory(lamps.scene);
  const auto view = laboratory.lights.view({glm::vec3(0), {0, 1, 0}});
  constexpr int kDraws = 40000;
  std::mt19937 random(12);
  const Estimate seen = estimate(kDraws, [&](uint32_t) {
    LightSample sample;
    const float pick = uniform(random);
    const glm::vec2 u(uniform(random), uniform(random));
    return laboratory.lights.sample(view, pick, u, sample) ? sample.radiance.x * sample.wi.y / sample.pdf : 0.0f;
  });
  EXPECT_NEAR(seen.mean, lamps.irradiance, 3 * seen.error);
  EXPECT_LT(5 * kDraws * seen.error * seen.error, variance_by_power(lamps));
}

}  // namespace
}  // namespace vitrine::test
