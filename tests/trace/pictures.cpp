// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Whole frames: layers, coverage, reproducibility.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <map>

#include "host/trace/tracer.h"
#include "tests/trace/measure.h"
#include "tests/trace/scenes.h"

namespace vitrine::test {
namespace {

// A little of everything: glass, metal, plastic, a lamp, a sun, an environment, a moving object.
Scene still_life() {
  Scene scene = scene_with_camera({0, 1.2f, 4}, {0, 0.5f, 0}, 0.6f);
  set_environment(scene, {0.2f, 0.25f, 0.3f});
  Material plastic;
  plastic.metallic = 0;
  plastic.roughness = 0.4f;
  plastic.base_color = {0.7f, 0.3f, 0.2f, 1};
  add_object(scene, make_quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), add_material(scene, plastic), "floor");
  add_object(scene, make_sphere({-0.8f, 0.5f, 0}, 0.5f, 16), add_material(scene, clear_glass(1.5f, 0, 1)), "glass");
  add_object(scene, make_sphere({0.6f, 0.5f, 0}, 0.5f, 16), add_material(scene, metal({0.9f, 0.7f, 0.4f}, 0.3f)), "metal");
  add_object(scene, make_sphere({0, 2.5f, 0}, 0.1f, 8), add_material(scene, lamp(glm::vec3(60))), "lamp");
  Light sun;
  sun.kind = LightKind::kDirectional;
  sun.intensity = glm::vec3(0.7f);
  add_light(scene, sun, {0, 5, 0}, {0.3f, -1, -0.2f});
  return scene;
}

TraceOptions small_picture() {
  TraceOptions options;
  options.width = 50;
  options.height = 38;
  options.samples_per_pixel = 16;
  return options;
}

TEST(Picture, LayersTimesCoverageSumToTheCombinedPicture) {
  Scene scene = still_life();
  Object backdrop;
  backdrop.name = "background";
  backdrop.follows_camera = true;
  scene.objects.push_back(backdrop);
  scene.background_object = static_cast<int>(scene.objects.size()) - 1;
  const Frame frame = Tracer(scene).render({}, small_picture());
  std::vector<glm::vec3> sum(frame.combined.size(), glm::vec3(0));
  std::vector<float> coverage(frame.combined.size(), 0.0f);
  for (const ObjectFrame& o : frame.objects) {
    for (int i = 0; i < o.width * o.height; ++i) {
      const auto k = static_cast<size_t>(i);
      const auto pixel = static_cast<size_t>((o.y + i / o.width) * frame.width + o.x + i % o.width);
      sum[pixel] += o.coverage[k] * (o.diffuse[k] + o.specular[k]);
      coverage[pixel] += o.coverage[k];
      if (o.coverage[k] == 0) {
        EXPECT_EQ(o.diffuse[k] + o.specular[k], glm::vec3(0));
      }
    }
  }
  for (size_t i = 0; i < sum.size(); ++i) {
    EXPECT_NEAR(coverage[i], 1, 1e-5);  // the backdrop takes what nothing else covers
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[i][c], frame.combined[i][c], 1e-5 * (1 + frame.combined[i][c]));
  }
}

TEST(Picture, WithoutABackdropCoverageStaysBelowOne) {
  const Scene scene = still_life();
  const Frame frame = Tracer(scene).render({}, small_picture());
  std::vector<float> coverage(frame.combined.size(), 0.0f);
  for (const ObjectFrame& o : frame.objects) {
    for (int i = 0; i < o.width * o.height; ++i) {
      coverage[static_cast<size_t>((o.y + i / o.width) * frame.width + o.x + i % o.width)] += o.coverage[static_cast<size_t>(i)];
    }
  }
  EXPECT_LE(*std::max_element(coverage.begin(), coverage.end()), 1 + 1e-5f);
  EXPECT_EQ(*std::min_element(coverage.begin(), coverage.end()), 0);
}

TEST(Picture, EdgesAreFilteredAsThePixelFilterSays) {
  Scene scene = scene_with_camera({0, 0, 1}, {0, 0, 0}, 0.5f);
  scene.camera.perspective = false;
  scene.camera.ymag = 4;
  // A half plane whose edge is at the centre of a column of pixels: it covers one half there, and F(1), F(-1) beside it.
  add_object(scene, make_quad({0.5f, -9, 0}, {9, 0, 0}, {0, 18, 0}), add_material(scene, lambert(glm::vec3(1))), "half");
  TraceOptions options;
  options.width = options.height = 8;
  options.samples_per_pixel = 4096;
  const Frame frame = Tracer(scene).render({}, options);
  ASSERT_EQ(frame.objects.size(), 1u);
  const ObjectFrame& o = frame.objects[0];
  EXPECT_EQ(o.x, 4);  // the filter's radius is one pixel: the column left of the edge's sees nothing
  EXPECT_NEAR(o.coverage[0], 0.5, 0.01);
  EXPECT_EQ(o.coverage[1], 1);
}

TEST(Picture, TwoFramesOfAnObjectAreComparedWhereBothShowIt) {
  const auto window = [](int x, int y, int width, int height) {
    ObjectFrame o;
    o.x = x, o.y = y, o.width = width, o.height = height;
    return o;
  };
  const auto common = [](const ObjectFrame& a, const ObjectFrame& b) {
    std::vector<std::pair<size_t, size_t>> pixels;
    for_each_common_pixel(a, b, [&](size_t i, size_t j) { pixels.emplace_back(i, j); });
    return pixels;
  };
  const ObjectFrame a = window(2, 1, 4, 3);
  // Columns 4 and 5 of rows 2 and 3.
  const std::vector<std::pair<size_t, size_t>> expected = {{6, 0}, {7, 1}, {10, 5}, {11, 6}};
  EXPECT_EQ(common(a, window(4, 2, 5, 9)), expected);
  EXPECT_EQ(common(a, a).size(), 12u);
  EXPECT_TRUE(common(a, window(6, 1, 4, 3)).empty());  // side by side
  EXPECT_TRUE(common(a, window(0, 0, 0, 0)).empty());  // not seen
}

bool same(const Frame& a, const Frame& b) {
  if (a.combined != b.combined || a.objects.size() != b.objects.size()) return false;
  for (size_t i = 0; i < a.objects.size(); ++i) {
    const ObjectFrame &p = a.objects[i], &q = b.objects[i];
    if (p.object != q.object || p.x != q.x || p.y != q.y || p.width != q.width || p.height != q.height) return false;
    if (p.coverage != q.coverage || p.diffuse != q.diffuse || p.specular != q.specular) return false;
  }
  return true;
}

TEST(Picture, DoesNotDependOnThreadsOrOnWhatWasRenderedBefore) {
  const Scene scene = still_life();
  // Four threads even where the machine has fewer cores.
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 4);
  Frame alone, among_others;
  tbb::task_arena(1).execute([&] { alone = Tracer(scene).render({}, small_picture()); });
  Tracer tracer(scene);
  tbb::task_arena(4).execute([&] {
    TraceOptions other = small_picture();
    other.seed = 9;
    tracer.render({}, other);
    among_others = tracer.render({}, small_picture());
  });
  EXPECT_TRUE(same(alone, among_others));
}

TEST(Picture, SeedsGiveIndependentNoise) {
  const Scene scene = still_life();
  Tracer tracer(scene);
  TraceOptions options = small_picture();
  const auto noisy = [&](uint32_t seed) {
    options.seed = seed;
    return tracer.render({}, options).combined;
  };
  const auto a = noisy(1), b = noisy(2), c = noisy(3), d = noisy(4);
  // Differences of disjoint pairs are uncorrelated. Bounded, so that no few bright pixels decide.
  double ab_cd = 0, ab2 = 0, cd2 = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double p = std::clamp(a[i].y - b[i].y, -0.005f, 0.005f), q = std::clamp(c[i].y - d[i].y, -0.005f, 0.005f);
    ab_cd += p * q;
    ab2 += p * p;
    cd2 += q * q;
  }
  EXPECT_GT(ab2, 0);
  EXPECT_LT(std::fabs(ab_cd) / std::sqrt(ab2 * cd2), 4 / std::sqrt(static_cast<double>(a.size())));
}

// Mean squared differences of two pictures' layers in parts of display white, for every object that is seen in both.
std::map<int, std::array<double, 2>> differences(const Frame& a, const Frame& b) {
  std::map<int, std::array<double, 2>> result;
  for (const ObjectFrame& p : a.objects)
    for (const ObjectFrame& q : b.objects) {
      if (p.object != q.object) continue;
      std::array<double, 2> sum{};
      int count = 0;
      for_each_common_pixel(p, q, [&](size_t i, size_t j) {
        const glm::vec3 d = glm::clamp(p.diffuse[i] - q.diffuse[j], -1.0f, 1.0f),
                        s = glm::clamp(p.specular[i] - q.specular[j], -1.0f, 1.0f);
        sum[0] += glm::dot(d, d) / 3;
        sum[1] += glm::dot(s, s) / 3;
        ++count;
      });
      result[p.object] = {sum[0] / count, sum[1] / count};
    }
  return result;
}

TEST(Picture, RaysAreGivenUntilEveryLayerIsAsCleanAsWasAskedFor) {
  const Scene scene = still_life();
  Tracer tracer(scene);
  TraceOptions options = small_picture();
  options.samples_per_pixel = 4096;
  for (const double asked : {25.0, 31.0}) {
    options.noise_db = asked;
    const Frame frame = tracer.render({}, options);
    ASSERT_FALSE(frame.noise.empty());
    for (const NoiseReport& n : frame.noise) {
      SCOPED_TRACE(testing::Message() << "object " << n.object << ", asked " << asked);
      EXPECT_GT(n.diffuse_db, asked - 0.5);
      EXPECT_GT(n.specular_db, asked - 0.5);
    }
  }
}

TEST(Picture, EstimatedNoiseIsNotBelowWhatTwoSeedsShow) {
  const Scene scene = still_life();
  Tracer tracer(scene);
  TraceOptions options = small_picture();
  options.samples_per_pixel = 4096;
  options.noise_db = 28;
  const Frame a = tracer.render({}, options);
  options.seed = 1;
  const Frame b = tracer.render({}, options);
  for (const auto& [object, squares] : differences(a, b)) {
    // Codes rise by about as much as light in the middle of their range; dark parts are steeper: an order of magnitude is told.
    EXPECT_LT(squares[0], 10 * std::pow(10, -2.8)) << object;
    EXPECT_LT(squares[1], 10 * std::pow(10, -2.8)) << object;
  }
}

TEST(Picture, AnEvenBudgetIsSpentWhereNothingBetterIsKnownAndNeverExceeded) {
  const Scene scene = still_life();
  Tracer tracer(scene);
  TraceOptions options = small_picture();
  options.samples_per_pixel = 8;
  EXPECT_EQ(tracer.render({}, options).rays_per_pixel, 8);
  options.noise_db = 60;  // out of reach
  const double spent = tracer.render({}, options).rays_per_pixel;
  EXPECT_LT(spent, 8.5);
  EXPECT_GT(spent, 6);
}

// A pixel's number of samples follows its neighbours' samples, not its own: the mean over seeds is that of even sampling.
TEST(Picture, GivingRaysByNeedMakesNothingBrighterOrDarker) {
  const Scene scene = still_life();
  Tracer tracer(scene);
  TraceOptions options = small_picture();
  options.samples_per_pixel = 1024;
  options.seed = 99;
  const Frame clean = tracer.render({}, options);
  options.noise_db = 20;
  const auto mean_of = [](const Frame& f) {
    double sum = 0;
    for (const glm::vec3& c : f.combined) sum += std::min(trace::luminance(c), 1.0f);
    return sum / static_cast<double>(f.combined.size());
  };
  const Estimate mean = estimate(24, [&](uint32_t seed) {
    options.seed = seed;
    return mean_of(tracer.render({}, options));
  });
  // Beyond chance: cutting at white takes more from the noisier pictures.
  EXPECT_NEAR(mean.mean, mean_of(clean), 4 * mean.error + 0.004 * mean.mean);
}

// An unlit black wall, seen from the front in 32 x 32 pixels that are 1 wide: x and y run from -16 to 16.
Scene wall_seen_from_the_front() {
  Scene scene = scene_with_camera({0, 0, 5}, {0, 0, 0}, 0.5f);
  scene.camera.perspective = false;
  scene.camera.ymag = 16;
  Material black;
  black.unlit = true;
  black.base_color = {0, 0, 0, 1};
  add_object(scene, make_quad({-64, -64, -1}, {128, 0, 0}, {0, 128, 0}), add_material(scene, black), "wall");
  return scene;
}

// The mean over seeds of the pictures' mean luminance.
Estimate mean_light(const Scene& scene, TraceOptions options, int seeds) {
  Tracer tracer(scene);
  options.width = options.height = 32;
  return estimate(seeds, [&](uint32_t seed) {
    options.seed = seed;
    double sum = 0;
    for (const glm::vec3& c : tracer.render({}, options).combined) sum += trace::luminance(c);
    return sum / 1024;
  });
}

// The tests below ask for little and for much: the passes are few and many then.
constexpr double kNoiseTargets[] = {30, 45, 60};

// Two samples of a pixel hardly ever find such a dot. Those pixels that were given more because they found it would average
// over fewer misses.
TEST(Picture, DotsFarSmallerThanAPixelKeepTheirLightWhateverNoiseIsAskedFor) {
  Scene scene = wall_seen_from_the_front();
  const int white = add_material(scene, lamp(glm::vec3(1)));
  for (int i = 0; i < 64; ++i) {
    const glm::vec3 corner(-13.65f + 4 * static_cast<float>(i % 8), -13.65f + 4 * static_cast<float>(i / 8), 0);
    add_object(scene, make_quad(corner, {0.3f, 0, 0}, {0, 0.3f, 0}), white, "dot");
  }
  for (const double noise : kNoiseTargets) {
    SCOPED_TRACE(testing::Message() << noise << " dB");
    EXPECT_ESTIMATE(mean_light(scene, {.noise_db = noise}, 200), 64 * 0.3 * 0.3 / 1024, 0);
  }
}

TEST(Picture, LinesThinnerThanAPixelKeepTheirLightWhateverNoiseIsAskedFor) {
  Scene scene = wall_seen_from_the_front();
  const int white = add_material(scene, lamp(glm::vec3(1)));
  for (int i = 0; i < 5; ++i) {
    const glm::vec3 corner(-13.1f + 5.3f * static_cast<float>(i), -12, 0);
    add_object(scene, make_quad(corner, {0.2f, 0, 0}, {0, 24, 0}), white, "line");
  }
  for (const double noise : kNoiseTargets) {
    SCOPED_TRACE(testing::Message() << noise << " dB");
    EXPECT_ESTIMATE(mean_light(scene, {.noise_db = noise}, 100), 5 * 0.2 * 24 / 1024, 0);
  }
}

// Few pixels show each ball, and these alone tell how noisy it is.
TEST(Picture, SmallNoisyThingsKeepTheirLightWhateverNoiseIsAskedFor) {
  Scene scene = wall_seen_from_the_front();
  const int plastic = add_material(scene, [] {
    Material m;
    m.metallic = 0;
    m.roughness = 0.3f;
    return m;
  }());
  for (int i = 0; i < 49; ++i) {
    const glm::vec3 center(-12 + 4 * static_cast<float>(i % 7), -12 + 4 * static_cast<float>(i / 7), 0);
    add_object(scene, make_sphere(center, 0.8f, 8), plastic, "ball");
  }
  const int bright = add_material(scene, lamp(glm::vec3(40)));
  add_object(scene, make_sphere({0, 0, 30}, 4, 8), bright, "lamp behind the camera");
  add_object(scene, make_sphere({-20, 0, 2}, 2, 8), bright, "lamp beside the picture");
  const Estimate even = mean_light(scene, {.samples_per_pixel = 256}, 8);
  for (const double noise : kNoiseTargets) {
    SCOPED_TRACE(testing::Message() << noise << " dB");
    const Estimate e = mean_light(scene, {.noise_db = noise}, 50);
    EXPECT_NEAR(e.mean, even.mean, 3 * std::hypot(e.error, even.error));
  }
}

TEST(Picture, LayersThatManyViewsShareGetFewerRays) {
  const Scene scene = still_life();
  Tracer tracer(scene);
  TraceOptions options = small_picture();
  options.samples_per_pixel = 4096;
  options.noise_db = 38;
  const double alone = tracer.render({}, options).rays_per_pixel;
  options.views = 16;
  EXPECT_LT(tracer.render({}, options).rays_per_pixel, 0.9 * alone);
}

// The same light by sampling lights, by scattering, and by both.
TEST(Picture, LightStrategiesAgree) {
  Scene scene = still_life();
  scene.objects.erase(scene.objects.begin() + 1);  // glass: strategies differ on caustics by design
  scene.lights.clear();                            // the sun cannot be found by scattering
  scene.materials[3].emissive = glm::vec3(4);
  scene.objects[2].geometry = make_quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2});
  scene.objects[2].geometry.triangle_materials = {3, 3};
  const auto mean = [&](trace::LightStrategy strategy) {
    trace::PathSettings settings;
    settings.strategy = strategy;
    const Laboratory laboratory(scene, settings);
    return std::pair(laboratory.look({0, 1.2f, 4}, {-0.1f, -0.25f, -1}).sum,
                     laboratory.look({0, 1.2f, 4}, {0.15f, -0.15f, -1}).sum);
  };
  const auto both = mean(trace::LightStrategy::kBoth);
  for (const auto strategy : {trace::LightStrategy::kLightsOnly, trace::LightStrategy::kScatteringOnly}) {
    const auto one = mean(strategy);
    EXPECT_NEAR(one.first.mean, both.first.mean, 4 * std::hypot(one.first.error, both.first.error));
    EXPECT_NEAR(one.second.mean, both.second.mean, 4 * std::hypot(one.second.error, both.second.error));
  }
}

TEST(Picture, MaxRadianceBoundsOnlyIndirectLight) {
  Scene scene = still_life();
  const auto brightest = [](const Frame& f) {
    float peak = 0;
    for (const glm::vec3& p : f.combined) peak = std::max(peak, p.y);
    return peak;
  };
  scene.settings.max_radiance = 1e-6f;
  const Frame direct = Tracer(scene).render({}, small_picture());
  scene.settings.max_radiance = 0;
  const Frame all = Tracer(scene).render({}, small_picture());
  EXPECT_GT(brightest(direct), 0.05f);
  double direct_sum = 0, sum = 0;
  for (size_t i = 0; i < all.combined.size(); ++i) {
    direct_sum += direct.combined[i].y;
    sum += all.combined[i].y;
  }
  EXPECT_LT(direct_sum, sum);
}

}  // namespace
}  // namespace vitrine::test
