// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Tangents for normal maps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <iostream>

#include "host/scene/geometry.h"
#include "host/scene/gltf.h"
#include "host/scene/shapes.h"

namespace vitrine {
namespace {

Geometry quad(const std::array<glm::vec2, 4>& uv) {
  Geometry g;
  g.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  g.normals.assign(4, {0, 0, 1});
  g.texcoords[0].assign(uv.begin(), uv.end());
  g.indices = {0, 1, 2, 0, 2, 3};
  return g;
}

TEST(Tangents, UprightPictureHasItsUAlongXAndPositiveHandedness) {
  Geometry g = quad({glm::vec2(0, 1), {1, 1}, {1, 0}, {0, 0}});  // v points down
  make_tangents(g, 0, glm::mat3(1));
  for (const glm::vec4& t : g.tangents) EXPECT_LT(glm::distance(t, glm::vec4(1, 0, 0, 1)), 1e-6f);
}

TEST(Tangents, MirroredPictureHasNegativeHandedness) {
  Geometry g = quad({glm::vec2(1, 1), {0, 1}, {0, 0}, {1, 0}});
  make_tangents(g, 0, glm::mat3(1));
  for (const glm::vec4& t : g.tangents) EXPECT_LT(glm::distance(t, glm::vec4(-1, 0, 0, -1)), 1e-6f);
}

TEST(Tangents, VerticesOnAMirrorSeamAreDoubled) {
  Geometry g = quad({glm::vec2(0, 1), {1, 1}, {1, 0}, {0, 0}});
  g.positions.push_back({2, 0, 0});  // a second half on the right, its u running back
  g.normals.push_back({0, 0, 1});
  g.texcoords[0].push_back({0, 1});
  g.indices.insert(g.indices.end(), {1, 4, 2});
  make_tangents(g, 0, glm::mat3(1));
  ASSERT_EQ(g.positions.size(), 7u) << "vertices 1 and 2 serve both halves";
  for (size_t i = 0; i < 6; ++i) EXPECT_EQ(g.tangents[g.indices[i]].w, 1);
  for (size_t i = 6; i < 9; ++i) EXPECT_EQ(g.tangents[g.indices[i]].w, -1);
  EXPECT_EQ(g.positions[g.indices[6]], glm::vec3(1, 0, 0));
}

TEST(Tangents, TextureTransformTurnsThem) {
  Geometry g = quad({glm::vec2(0, 1), {1, 1}, {1, 0}, {0, 0}});
  make_tangents(g, 0, glm::mat3(0, 1, 0, -1, 0, 0, 0, 0, 1));  // u' = -v, v' = u
  for (const glm::vec4& t : g.tangents) EXPECT_LT(glm::distance(glm::vec3(t), glm::vec3(0, 1, 0)), 1e-6f) << "u' grows upwards";
}

TEST(Tangents, WithoutTextureAreaTheyStillLieInTheSurface) {
  Geometry g = quad({glm::vec2(0, 0), {0, 0}, {0, 0}, {0, 0}});
  make_tangents(g, 0, glm::mat3(1));
  for (const glm::vec4& t : g.tangents) {
    EXPECT_NEAR(glm::length(glm::vec3(t)), 1, 1e-6);
    EXPECT_NEAR(t.z, 0, 1e-6);
  }
}

TEST(Tangents, OnASphereTheyFollowTheParallels) {
  Geometry g = make_sphere(2, 48, 24);
  make_tangents(g, 0, glm::mat3(1));
  for (const uint32_t i : g.indices) {
    const glm::vec3 n = g.normals[i];
    if (std::abs(n.y) > 0.9f) continue;
    const glm::vec3 east = glm::normalize(glm::cross(glm::vec3(0, 1, 0), n));  // from +Z towards +X: u falls along it
    EXPECT_GT(std::abs(glm::dot(glm::vec3(g.tangents[i]), east)), 0.997f);
    EXPECT_NEAR(glm::dot(glm::vec3(g.tangents[i]), n), 0, 1e-5);
  }
}

// A model whose maker computed tangents with MikkTSpace: ours must agree with them.
TEST(Tangents, AgreeWithThoseOfARealModel) {
  const std::filesystem::path file = std::filesystem::path(VITRINE_EXTRA_ASSETS) / "assets/gltf/FlightHelmet/FlightHelmet.gltf";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file << ": tangents are not compared with a real model's";
  size_t corners = 0, alike = 0;
  for (const Object& object : read_gltf({file, {}, {}, {}, nullptr}).objects) {
    Geometry g = object.geometry;
    ASSERT_FALSE(g.tangents.empty());
    make_tangents(g, 0, glm::mat3(1));
    for (size_t i = 0; i < g.indices.size(); ++i) {
      const glm::vec4 theirs = object.geometry.tangents[object.geometry.indices[i]], ours = g.tangents[g.indices[i]];
      alike += glm::dot(glm::vec3(theirs), glm::vec3(ours)) > 0.98f && theirs.w == ours.w;
      ++corners;
    }
  }
  const double share = static_cast<double>(alike) / static_cast<double>(corners);
  std::cout << 100 * share << " % of " << corners << " corners within 11 degrees of the model's own tangents\n";
  EXPECT_GT(share, 0.95);
}

}  // namespace
}  // namespace vitrine
