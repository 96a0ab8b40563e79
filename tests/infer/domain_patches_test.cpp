// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/domain_patches.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <random>

#include "host/base/mesh_grid.h"
#include "host/infer/mesh_cuts.h"
#include "host/infer/rectangle_packing.h"
#include "host/infer/texture_layout.h"

namespace vitrine::testing {
namespace {

constexpr float kCoarse = VisibleSurface::kCoarseCells;

// Adds a part of the domain that is seen at so many pixels a unit of u and of v, n x n samples of it.
void show(const glm::vec2& low, const glm::vec2& high, const glm::vec2& pixels, VisibleSurface& surface, int n = 150) {
  std::vector<VisibleSurface::CellRow> rows(VisibleSurface::kCells);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const glm::vec2 at = low + (glm::vec2(i, j) + 0.5f) / static_cast<float>(n) * (high - low), uv = at - glm::floor(at);
      surface.add_sample({uv, glm::mat2(1 / pixels.x, 0, 0, 1 / pixels.y)});
      const glm::ivec2 cell(uv * float{VisibleSurface::kCells});
      rows[static_cast<size_t>(cell.y)].set(static_cast<size_t>(cell.x));
      surface.meet(uv - 1e-4f, uv + 1e-4f);
    }
  for (int row = 0; row < VisibleSurface::kCells; ++row) surface.see(row, rows[static_cast<size_t>(row)]);
}

// The front of an outer wall, the back of an inner one, and their rim all around; its seam runs through the back.
VisibleSurface vessel() {
  VisibleSurface surface;
  show({0.25f, 0.0f}, {0.75f, 0.45f}, {500, 500}, surface);
  show({0.75f, 0.55f}, {1.25f, 0.98f}, {500, 500}, surface);
  return surface;
}

double texels_on(const VisibleSurface& surface, const std::vector<DomainPart>& patches) {
  StateTable states;
  states.state_of_sample = {0};
  states.samples_of_state = {{0}};
  states.grid_states = 1;
  Field field;
  const VisibleSurface* seen = &surface;
  lay_out(states, {}, {&seen, 1}, patches, {}, field);
  return static_cast<double>(field.texture_width) * field.texture_height;
}

TEST(DomainPatches, WhatAVesselShowsOnOppositeSidesLiesSideBySide) {
  const VisibleSurface surface = vessel();
  const std::vector<DomainPart> patches = choose_patches(std::vector<WeightedSurface>{{surface}}, {});
  EXPECT_GE(patches.size(), 2u);
  EXPECT_LT(texels_on(surface, patches), 0.65 * texels_on(surface, {VisibleSurface::kWholeDomain}));
}

TEST(DomainPatches, WhatIsSeenAllAlikeIsNotCut) {
  VisibleSurface surface;
  show({0, 0}, {1, 1}, {300, 200}, surface);
  EXPECT_EQ(choose_patches(std::vector<WeightedSurface>{{surface}}, {}), (std::vector<DomainPart>{VisibleSurface::kWholeDomain}));
}

TEST(DomainPatches, WhatIsNearGetsItsTexelsAndWhatIsFarNoMore) {
  VisibleSurface floor;
  show({0, 0}, {1, 0.5f}, {900, 900}, floor);
  show({0, 0.5f}, {1, 1}, {100, 100}, floor, 50);
  const std::vector<DomainPart> patches = choose_patches(std::vector<WeightedSurface>{{floor}}, {});
  EXPECT_LT(texels_on(floor, patches), 0.75 * texels_on(floor, {VisibleSurface::kWholeDomain}));
}

TEST(DomainPatches, TheyTileTheDomain) {
  const std::vector<DomainPart> patches = choose_patches(std::vector<WeightedSurface>{{vessel()}}, {});
  ASSERT_LE(patches.size(), size_t{kMaxPatches});
  for (int v = 0; v < VisibleSurface::kCoarseCells; ++v)
    for (int u = 0; u < VisibleSurface::kCoarseCells; ++u) {
      int holding = 0;
      for (const DomainPart& p : patches) holding += u >= p.low.x && u < p.high.x && v >= p.low.y && v < p.high.y;
      ASSERT_EQ(holding, 1) << u << ' ' << v;
    }
}

const std::vector<DomainPart> kThree{{{0, 0}, {64, 30}}, {{0, 30}, {21, 64}}, {{21, 30}, {64, 64}}};

TEST(DomainPatches, EverySeenTexelLiesInTheSlotOfItsPatchAndGuttersLieBetween) {
  const VisibleSurface surface = vessel();
  for (const float scale : {1.0f, 2.0f}) {
    StateTable states;
    states.state_of_sample = {0};
    states.samples_of_state = {{0}};
    states.grid_states = 1;
    Field field;
    const VisibleSurface* seen = &surface;
    LayoutOptions options;
    options.fit.texels_per_pixel = scale;
    lay_out(states, {}, {&seen, 1}, kThree, options, field);
    const glm::vec2 size(field.texture_width, field.texture_height);
    std::array<glm::vec2, 3> low, high;
    low.fill(glm::vec2(1e9f)), high.fill(glm::vec2(-1e9f));
    for (size_t k = 0; k < 3; ++k) {
      const VisibleSurface own = surface.within(kThree[k]);
      for (const SurfaceSample& sample : own.samples()) {
        const glm::vec2 texel = size * field.maps[0](sample.uv + glm::vec2(kPatchStep * static_cast<float>(k), 0));
        low[k] = glm::min(low[k], texel);
        high[k] = glm::max(high[k], texel);
      }
    }
    const auto gutter = static_cast<float>(gutter_of(options.fit));
    EXPECT_EQ(gutter, 4 * scale);
    for (size_t k = 0; k < 3; ++k) {
      for (int d = 0; d < 2; ++d) {
        EXPECT_GE(low[k][d], kTextureMargin - 0.01f);
        EXPECT_LE(high[k][d], size[d] - kTextureMargin + 0.01f);
      }
      for (size_t other = 0; other < k; ++other) {
        const glm::vec2 apart = glm::max(low[k] - high[other], low[other] - high[k]);
        EXPECT_GE(std::max(apart.x, apart.y), gutter - 0.01f) << k << ' ' << other;
      }
    }
  }
}

TEST(DomainPatches, RectanglesDoNotOverlapAndLieWithinTheTexture) {
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    std::vector<std::vector<glm::ivec2>> sets(3, std::vector<glm::ivec2>(6));
    for (auto& sizes : sets)
      for (glm::ivec2& size : sizes) size = {random() % 90, random() % 60};
    const auto texture = smallest_texture(sets, 4, 8, 1024);
    ASSERT_TRUE(texture);
    EXPECT_EQ(texture->width % 8 + texture->height % 8, 0);
    for (const auto& sizes : sets) {
      const auto places = pack_rectangles(sizes, {texture->width + 4, texture->height + 4});
      ASSERT_TRUE(places);
      for (size_t i = 0; i < sizes.size(); ++i) {
        if (sizes[i].x * sizes[i].y == 0) continue;
        const glm::ivec2 end = (*places)[i] + sizes[i];
        ASSERT_TRUE((*places)[i].x >= 0 && (*places)[i].y >= 0 && end.x <= texture->width + 4 && end.y <= texture->height + 4);
        for (size_t j = 0; j < i; ++j) {
          const glm::ivec2 apart = glm::max((*places)[j] - end, (*places)[i] - (*places)[j] - sizes[j]);
          ASSERT_TRUE(sizes[j].x * sizes[j].y == 0 || std::max(apart.x, apart.y) >= 0);
        }
      }
    }
  }
  EXPECT_FALSE(smallest_texture(std::vector<std::vector<glm::ivec2>>{{{200, 200}, {200, 200}}}, 0, 8, 256));
}

// A wavy sheet of random triangles.
DrawnObject sheet() {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any(-0.3f, 0.3f);
  constexpr uint32_t n = 7;
  DrawnObject object;
  for (uint32_t j = 0; j <= n; ++j)
    for (uint32_t i = 0; i <= n; ++i) {
      const auto inner = [&](uint32_t k) { return (static_cast<float>(k) + (k > 0 && k < n ? any(random) : 0)) / float{n}; };
      const float u = inner(i), v = inner(j);
      object.vertices.push_back({u * 2, v, i == 0 || j == 0 || i == n || j == n ? 0 : any(random), u, v});
    }
  for (uint32_t j = 0; j < n; ++j)
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t at = j * (n + 1) + i;
      for (const uint32_t corner : {at, at + 1, at + n + 2, at, at + n + 2, at + n + 1}) object.indices.push_back(corner);
    }
  for (uint32_t t = 0; t < object.indices.size() / 3; ++t) object.triangles.push_back(t);
  object.culled_index_count = 30;
  object.grid = lay_on_grid(object.vertices);
  return object;
}

glm::vec3 position(const MeshVertex& v) { return {v.x, v.y, v.z}; }

std::array<double, 2> areas(const DrawnObject& object) {  // single-sided, and the rest
  std::array<double, 2> sums{};
  for (size_t i = 0; i < object.indices.size(); i += 3) {
    const auto corner = [&](size_t k) { return position(object.vertices[object.indices[i + k]]); };
    sums[i >= object.culled_index_count] +=
        static_cast<double>(glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0)))) / 2;
  }
  return sums;
}

TEST(DomainPatches, ACutSurfaceIsTheSameSurface) {
  const DrawnObject whole = sheet(), cut = cut_into_patches(whole, kThree);
  EXPECT_GT(cut.indices.size(), whole.indices.size());
  ASSERT_EQ(cut.triangles.size(), cut.indices.size() / 3);
  for (int side = 0; side < 2; ++side) EXPECT_NEAR(areas(cut)[side], areas(whole)[side], 1e-4);
  for (size_t i = 0; i < cut.indices.size(); i += 3) {
    const int patch = TextureMap::patch_of(cut.vertices[cut.indices[i]].u);
    const DomainPart& part = kThree[static_cast<size_t>(patch)];
    for (size_t k = 0; k < 3; ++k) {
      const MeshVertex& v = cut.vertices[cut.indices[i + k]];
      ASSERT_EQ(TextureMap::patch_of(v.u), patch);
      const glm::vec2 cell = kCoarse * glm::vec2(v.u - kPatchStep * static_cast<float>(patch), v.v);
      for (int d = 0; d < 2; ++d) ASSERT_TRUE(cell[d] >= part.low[d] - 1e-3f && cell[d] <= part.high[d] + 1e-3f);
    }
  }
}

// Every edge inside has a twin that runs the other way between the very same points.
TEST(DomainPatches, ACutSurfaceHasNoCracks) {
  const DrawnObject cut = cut_into_patches(sheet(), kThree);
  using Point = std::array<float, 3>;
  std::map<std::pair<Point, Point>, int> edges;
  for (size_t i = 0; i < cut.indices.size(); i += 3)
    for (size_t k = 0; k < 3; ++k) {
      const auto point = [&](size_t c) {
        const MeshVertex& v = cut.vertices[cut.indices[i + c % 3]];
        return Point{v.x, v.y, v.z};
      };
      ++edges[{point(k), point(k + 1)}];
    }
  for (const auto& [edge, count] : edges) {
    const auto on_border = [&](int d, float at) {
      return std::fabs(edge.first[d] - at) < 1e-4f && std::fabs(edge.second[d] - at) < 1e-4f;
    };
    if (on_border(0, 0) || on_border(0, 2) || on_border(1, 0) || on_border(1, 1)) continue;
    ASSERT_EQ(count, 1);
    ASSERT_TRUE(edges.count({edge.second, edge.first}));
  }
}

}  // namespace
}  // namespace vitrine::testing
