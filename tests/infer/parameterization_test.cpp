// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/parameterization.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <set>

#include "host/infer/charts.h"
#include "host/infer/uv_raster.h"
#include "host/scene/shapes.h"

namespace vitrine {
namespace {

Geometry without_texcoords(Geometry g) {
  g.texcoords[0].clear();
  return g;
}

// A tube, unrolled onto the texture.
Geometry unrolled_tube() {
  Geometry g;
  const int n = 24;
  for (int j = 0; j <= 4; ++j)
    for (int i = 0; i <= n; ++i) {
      const float a = 6.2831853f * static_cast<float>(i) / n, y = static_cast<float>(j) / 4;
      g.positions.emplace_back(std::cos(a), 3 * y, std::sin(a));
      g.texcoords[0].emplace_back(static_cast<float>(i) / n, y);
    }
  for (uint32_t j = 0; j < 4; ++j)
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t w = n + 1, a = j * w + i;
      g.indices.insert(g.indices.end(), {a, a + 1, a + w, a + 1, a + w + 1, a + w});
    }
  return g;
}

Geometry torus(int columns, int rows) {
  Geometry g;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const float a = 6.2831853f * static_cast<float>(i) / static_cast<float>(columns),
                  b = 6.2831853f * static_cast<float>(j) / static_cast<float>(rows);
      g.positions.emplace_back((2 + 0.7f * std::cos(b)) * std::cos(a), 0.7f * std::sin(b),
                               (2 + 0.7f * std::cos(b)) * std::sin(a));
    }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const auto at = [&](int x, int y) { return static_cast<uint32_t>((y % rows) * columns + x % columns); };
      g.indices.insert(g.indices.end(), {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  return g;
}

// A ramp that winds up around an axis: all normals look up, so one chart would lie on itself turn upon turn.
Geometry spiral_ramp(int turns) {
  Geometry g;
  const int steps = 32 * turns;
  for (int i = 0; i <= steps; ++i) {
    const float a = 6.2831853f * static_cast<float>(i) / 32, y = 0.02f * static_cast<float>(i);
    g.positions.emplace_back(std::cos(a), y, std::sin(a));
    g.positions.emplace_back(2 * std::cos(a), y, 2 * std::sin(a));
  }
  for (uint32_t i = 0; i < static_cast<uint32_t>(steps); ++i)
    g.indices.insert(g.indices.end(), {2 * i, 2 * i + 2, 2 * i + 1, 2 * i + 1, 2 * i + 2, 2 * i + 3});
  return g;
}

Geometry noise(int triangles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> any(-1, 1);
  Geometry g;
  for (int i = 0; i < 3 * triangles; ++i) {
    g.positions.emplace_back(any(random), any(random), any(random));
    g.indices.push_back(static_cast<uint32_t>(i));
  }
  return g;
}

// Noise that hangs together: one vertex of every triangle anywhere, so neighbours fold over each other.
Geometry crumpled_sheet(int n) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> any(-1, 1);
  Geometry g;
  for (int i = 0; i <= n * n + 2 * n; ++i) g.positions.emplace_back(any(random), any(random), any(random));
  for (uint32_t j = 0; j < static_cast<uint32_t>(n); ++j)
    for (uint32_t i = 0; i < static_cast<uint32_t>(n); ++i) {
      const uint32_t w = static_cast<uint32_t>(n) + 1, a = j * w + i;
      g.indices.insert(g.indices.end(), {a, a + 1, a + w, a + 1, a + w + 1, a + w});
    }
  return g;
}

double uv_area(std::span<const glm::vec2> c) {
  const glm::dvec2 p(c[1] - c[0]), q(c[2] - c[0]);
  return std::fabs(p.x * q.y - p.y * q.x) / 2;
}
double surface_area(const Geometry& g, size_t t) {
  const glm::vec3 a = g.positions[g.indices[3 * t]], b = g.positions[g.indices[3 * t + 1]], c = g.positions[g.indices[3 * t + 2]];
  return static_cast<double>(glm::length(glm::cross(b - a, c - a))) / 2;
}

void expect_proper(const Geometry& g, const std::vector<glm::vec2>& corners) {
  ASSERT_EQ(corners.size(), g.indices.size());
  for (const glm::vec2& c : corners) {
    ASSERT_TRUE(c.x >= 0 && c.x <= 1 && c.y >= 0 && c.y <= 1) << c.x << " " << c.y;
  }
  const UvCoverage coverage = measure_uv_coverage(corners, 2048);
  EXPECT_LE(coverage.overlapped, coverage.covered / 200);
}

struct Shape {
  const char* name;
  Geometry geometry;
};
std::vector<Shape> shapes() {
  return {{"sphere", without_texcoords(make_sphere(1, 32, 16))},
          {"box", without_texcoords(make_box({1, 2, 3}))},
          {"torus", torus(48, 24)},
          {"spiral", spiral_ramp(4)},
          {"crumpled", crumpled_sheet(20)}};
}

TEST(Parameterization, EveryPointOfTheSurfaceHasAPlaceOfItsOwn) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    expect_proper(shape.geometry, texture_domain(shape.geometry, glm::mat4(1)));
  }
}

TEST(Parameterization, AreasStayInProportion) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const auto corners = texture_domain(shape.geometry, glm::mat4(1));
    double texture_sum = 0, surface_sum = 0;
    for (size_t t = 0; t < corners.size() / 3; ++t) {
      texture_sum += uv_area(std::span(corners).subspan(3 * t, 3));
      surface_sum += surface_area(shape.geometry, t);
    }
    // Projection shortens by the cosine of 65 degrees at most; on the mean by less.
    for (size_t t = 0; t < corners.size() / 3; ++t) {
      const double share =
          uv_area(std::span(corners).subspan(3 * t, 3)) / texture_sum / (surface_area(shape.geometry, t) / surface_sum);
      EXPECT_GT(share, 0.4) << "triangle " << t;
      EXPECT_LT(share, 1.5) << "triangle " << t;
    }
  }
}

TEST(Parameterization, ABoxBecomesSixRectanglesThatFillTheTexture) {
  const auto corners = texture_domain(without_texcoords(make_box({1, 1, 1})), glm::mat4(1));
  double area = 0;
  for (size_t t = 0; t < corners.size() / 3; ++t) area += uv_area(std::span(corners).subspan(3 * t, 3));
  EXPECT_GT(area, 0.6);
}

TEST(Parameterization, GoodTextureCoordinatesAreTaken) {
  const Geometry tube = unrolled_tube();
  EXPECT_TRUE(is_proper_parameterization(tube, glm::mat4(1)));
  const auto corners = texture_domain(tube, glm::mat4(1));
  for (size_t i = 0; i < corners.size(); ++i) ASSERT_EQ(corners[i], tube.texcoords[0][tube.indices[i]]);
}

TEST(Parameterization, SpheresAndDomesKeepTheirOwnCoordinates) {  // charts of their own would cost them their seamlessness
  EXPECT_TRUE(is_proper_parameterization(make_sphere(1, 32, 16), glm::mat4(1)));
  EXPECT_TRUE(is_proper_parameterization(make_dome(1, 32, 16), glm::mat4(1)));
}

TEST(Parameterization, RepeatedOverlappingOrBrokenCoordinatesAreNot) {
  Geometry repeated = unrolled_tube();
  for (glm::vec2& t : repeated.texcoords[0]) t *= 3.0f;
  EXPECT_FALSE(is_proper_parameterization(repeated, glm::mat4(1)));

  Geometry mirrored = unrolled_tube();  // both halves share one half of the texture
  for (glm::vec2& t : mirrored.texcoords[0]) t.x = std::min(t.x, 1 - t.x);
  EXPECT_FALSE(is_proper_parameterization(mirrored, glm::mat4(1)));

  Geometry stacked = make_box({1, 1, 1});  // all six sides on one square
  for (glm::vec2& t : stacked.texcoords[0]) t = glm::fract(t * glm::vec2(3, 2));
  EXPECT_FALSE(is_proper_parameterization(stacked, glm::mat4(1)));

  Geometry broken = unrolled_tube();
  broken.texcoords[0][5].x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(is_proper_parameterization(broken, glm::mat4(1)));

  Geometry point = unrolled_tube();
  for (glm::vec2& t : point.texcoords[0]) t = {0.5f, 0.5f};
  EXPECT_FALSE(is_proper_parameterization(point, glm::mat4(1)));
  Geometry cramped = unrolled_tube();  // three quarters of the surface on a thousandth of the texture
  for (glm::vec2& t : cramped.texcoords[0]) t.y = t.y < 0.3f ? t.y * 3.9f : 0.999f + 0.001f * t.y;
  EXPECT_FALSE(is_proper_parameterization(cramped, glm::mat4(1)));
  EXPECT_FALSE(is_proper_parameterization(without_texcoords(make_sphere(1, 8, 4)), glm::mat4(1)));
}

TEST(Parameterization, AHundredThousandLooseTrianglesTakeSeconds) {
  const auto begin = std::chrono::steady_clock::now();
  const Geometry g = noise(100000);
  const auto corners = texture_domain(g, glm::mat4(1));
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 10);
  expect_proper(g, corners);
  for (size_t t = 0; t < corners.size() / 3; ++t) ASSERT_GT(uv_area(std::span(corners).subspan(3 * t, 3)), 1e-7);
}

TEST(Parameterization, DegenerateMeshesAreLaidOutSomehow) {
  Geometry g;
  g.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 0, 0}};
  g.indices = {0, 1, 2, 0, 0, 0, 0, 3, 1};
  for (const glm::vec2& c : texture_domain(g, glm::mat4(1))) EXPECT_TRUE(c.x >= 0 && c.x <= 1 && c.y >= 0 && c.y <= 1);
}

TEST(Parameterization, WeldedSeamsAreNeighbours) {
  const Geometry box = make_box({1, 1, 1});  // 24 vertices, 8 places
  for (const int32_t n : edge_neighbors(box.positions, box.indices)) EXPECT_GE(n, 0);
}

TEST(Parameterization, SingleSidedTrianglesComeFirst) {
  Scene scene;
  scene.materials.resize(3);
  scene.materials[1].double_sided = true;
  scene.materials[2].transmission = 1;
  Object object;
  object.geometry = make_box({1, 1, 1});
  object.geometry.triangle_materials = {0, 0, 1, 1, 0, 0, 2, 2, 0, 0, 0, 0};
  scene.objects.push_back(object);
  DrawnObject drawn = make_drawn_object(scene, 0, glm::mat4(1));
  EXPECT_EQ(drawn.indices.size(), 36u);
  EXPECT_EQ(drawn.culled_index_count, 24u);
  scene.objects[0].variant_materials = {std::vector<int>(12, 0), std::vector<int>(12, 1)};  // double-sided in a variant
  EXPECT_EQ(make_drawn_object(scene, 0, glm::mat4(1)).culled_index_count, 0u);
}

TEST(Parameterization, AMirroringOrFlatteningNodeDoesNotBreakIt) {
  const Geometry g = without_texcoords(make_sphere(1, 16, 8));
  glm::mat4 odd(1);
  odd[0][0] = -2;
  odd[1][1] = 0;
  for (const glm::vec2& c : texture_domain(g, odd)) ASSERT_TRUE(c.x >= 0 && c.x <= 1 && c.y >= 0 && c.y <= 1);
}

TEST(UvCoverage, SharedEdgesAreCountedOnce) {
  const std::array<glm::vec2, 6> square{{{0, 0}, {1, 0}, {0, 1}, {1, 0}, {1, 1}, {0, 1}}};
  const UvCoverage coverage = measure_uv_coverage(square, 64);
  EXPECT_EQ(coverage.covered, 64 * 64);
  EXPECT_EQ(coverage.overlapped, 0);
}

TEST(UvCoverage, OverlapIsTheSharedArea) {
  const std::array<glm::vec2, 6> twice{{{0, 0}, {1, 0}, {0, 1}, {0, 0}, {0, 1}, {1, 0}}};
  const UvCoverage coverage = measure_uv_coverage(twice, 64);
  EXPECT_EQ(coverage.covered, coverage.overlapped);
  EXPECT_NEAR(static_cast<double>(coverage.covered), 64 * 64 / 2, 64);
}

}  // namespace
}  // namespace vitrine
