// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/base/mesh_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace vitrine {
namespace {

std::vector<MeshVertex> random_vertices(const glm::vec3& center, const glm::vec3& extent, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<MeshVertex> vertices;
  for (int i = 0; i < 300; ++i)
    vertices.push_back({center.x + extent.x * (unit(random) - 0.5f), center.y + extent.y * (unit(random) - 0.5f),
                        center.z + extent.z * (unit(random) - 0.5f), unit(random), unit(random)});
  return vertices;
}

struct Case {
  glm::vec3 center, extent;
};
const Case kCases[] = {{{0, 0, 0}, {1, 2, 0.1f}}, {{5, -3, 2}, {0.01f, 0.02f, 0.03f}}, {{1000, 0, 0}, {0.5f, 0.5f, 0}},
                       {{0, 1e6f, 0}, {1, 1, 1}}, {{0, 0, 0}, {0, 0, 0}}, {{2, 2, 2}, {0, 0, 0}}};

TEST(MeshGrid, VerticesOnTheGridStayWhereTheyAreWhenTheyAreCoded) {
  for (const Case& c : kCases) {
    std::vector<MeshVertex> vertices = random_vertices(c.center, c.extent, 1);
    const MeshGrid grid = lay_on_grid(vertices);
    for (const MeshVertex& v : vertices) {
      const MeshVertex again = vertex_on_grid(grid, nearest_on_grid(grid, v));
      EXPECT_EQ(again.x, v.x);
      EXPECT_EQ(again.y, v.y);
      EXPECT_EQ(again.z, v.z);
      EXPECT_EQ(again.u, v.u);
      EXPECT_EQ(again.v, v.v);
    }
  }
}

TEST(MeshGrid, NoVertexMovesByMoreThanHalfAStep) {
  for (const Case& c : kCases) {
    const std::vector<MeshVertex> before = random_vertices(c.center, c.extent, 2);
    std::vector<MeshVertex> after = before;
    const MeshGrid grid = lay_on_grid(after);
    const float rounding = 2e-7f * std::max({std::fabs(c.center.x), std::fabs(c.center.y), std::fabs(c.center.z)});
    for (size_t i = 0; i < before.size(); ++i) {
      EXPECT_LE(std::fabs(after[i].x - before[i].x), 0.51f * grid.step + rounding);
      EXPECT_LE(std::fabs(after[i].y - before[i].y), 0.51f * grid.step + rounding);
      EXPECT_LE(std::fabs(after[i].z - before[i].z), 0.51f * grid.step + rounding);
      EXPECT_LE(std::fabs(after[i].u - before[i].u), 0.501f / kTextureSteps);
    }
  }
}

TEST(MeshGrid, TextureCoordinatesAtTheEndsOfTheDomainAreExact) {
  std::vector<MeshVertex> vertices{{0, 0, 0, 0, 1}, {1, 0, 0, 1, 0.5f}};
  lay_on_grid(vertices);
  EXPECT_EQ(vertices[0].u, 0);
  EXPECT_EQ(vertices[0].v, 1);
  EXPECT_EQ(vertices[1].u, 1);
  EXPECT_EQ(vertices[1].v, 0.5f);
}

}  // namespace
}  // namespace vitrine
