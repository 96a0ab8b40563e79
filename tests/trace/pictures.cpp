// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Whole frames: layers, coverage, reproducibility, and independent references.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>

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

TEST(Picture, DISABLED_MoreRaysForReflectionsMakeThemCleanerAndNoBrighter) {
  const Scene scene = still_life();
  Tracer tracer(scene);
  TraceOptions options = small_picture();
  options.samples_per_pixel = 512;
  const Frame clean = tracer.render({}, options);
  options.samples_per_pixel = 8;
  options.seed = 5;
  // Sum of differences from the clean picture over the pixels that show the metal ball, bounded against single bright ones.
  const auto compare = [&](int factor) {
    options.noise_db = factor;
    const Frame frame = tracer.render({}, options);
    double sum = 0, squares = 0;
    int count = 0;
    const ObjectFrame& ball = *std::find_if(frame.objects.begin(), frame.objects.end(), [](const ObjectFrame& o) { return o.object == 2; });
    for (int y = 0; y < ball.height; ++y)
      for (int x = 0; x < ball.width; ++x) {
        if (ball.coverage[static_cast<size_t>(y * ball.width + x)] < 1) continue;
        const auto pixel = static_cast<size_t>((ball.y + y) * frame.width + ball.x + x);
        const double difference = std::clamp(frame.combined[pixel].y - clean.combined[pixel].y, -0.2f, 0.2f);
        sum += difference;
        squares += difference * difference;
        ++count;
      }
    return std::array{sum / count, squares / count, static_cast<double>(count)};
  };
  const auto even = compare(1), more = compare(3);
  ASSERT_GT(more[2], 30);
  EXPECT_LT(more[1], 0.4 * even[1]);  // twelve times the rays
  EXPECT_LT(std::fabs(more[0]), 4 * std::sqrt(more[1] / more[2]));
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

// Region means of pictures by an independent renderer. A quarter of the width and height is enough for means of regions.
class Reference : public testing::TestWithParam<std::pair<const char*, double>> {};

TEST_P(Reference, RegionsHaveTheMeansOfAnIndependentRenderer) {
  const std::string stem = std::string(VITRINE_EXTRA_ASSETS) + "/reference/" + GetParam().first;
  std::ifstream file(stem + ".json");
  if (!file) GTEST_SKIP() << "no reference pictures at " << stem;
  const auto json = nlohmann::json::parse(file);
  const auto scene = load_scene(stem + ".toml");
  const Laboratory laboratory(*scene, {0, trace::LightStrategy::kBoth, false});  // true caustics, as the reference has them
  const int width = scene->settings.width, height = scene->settings.height;
  const float half = std::tan(scene->camera.yfov / 2);
  const glm::mat4 view = laboratory.world->current_pose().world_from_camera;
  for (const auto& [name, box] : json["regions"].items()) {
    const double x0 = box[0], y0 = box[1], w = box[2], h = box[3];
    for (int c = 0; c < 3; ++c) {
      const Estimate mean = estimate(16, [&](uint32_t seed) {
        constexpr int kSamples = 128;
        double sum = 0;
        for (uint32_t s = 0; s < kSamples; ++s) {
          trace::Sampler sampler(1, 2, s, seed);
          sampler.start_vertex(0, 0);
          const glm::vec2 u = sampler.get2d();
          const double x = 2 * (x0 + u.x * w) / width - 1, y = 1 - 2 * (y0 + u.y * h) / height;
          const glm::vec3 d(x * half * width / height, y * half, -1);
          const auto sample = laboratory.integrator.trace({glm::vec3(view[3]), glm::normalize(glm::mat3(view) * d)}, sampler);
          sum += (sample.diffuse[c] + sample.view[c] + sample.specular[c]) / kSamples;
        }
        return sum;
      });
      const double expected = json["mean"][name][c];
      EXPECT_NEAR(mean.mean, expected, 4 * mean.error + GetParam().second * expected) << name << ", channel " << c;
    }
  }
}

// Slack: the renderers' models differ (Schlick, multiple scattering between facets at roughness 1), as does the tessellation.
INSTANTIATE_TEST_SUITE_P(All, Reference,
                         testing::Values(std::pair("cornell", 0.015), std::pair("metals", 0.05), std::pair("glass", 0.03),
                                         std::pair("amber_frost", 0.03)),
                         [](const auto& parameter) { return std::string(parameter.param.first); });

}  // namespace
}  // namespace vitrine::test
