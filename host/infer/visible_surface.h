// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What a geometry state shows of an object's surface, read off a rendering of triangle numbers: which part of the texture
// domain, and how the picture runs through it.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "host/infer/test_renderer.h"

namespace vitrine {

// A place on the surface, in the mesh's own texture coordinates, and how they change from one output pixel to the next.
struct SurfaceSample {
  glm::vec2 uv{0};
  glm::mat2 uv_per_pixel{0};  // columns: along x, along y (upwards)
};

// A rectangle of the domain, in its coarse cells (VisibleSurface::kCoarseCells); `high` lies beyond it.
struct DomainPart {
  glm::ivec2 low{0}, high{0};
  bool operator==(const DomainPart&) const = default;
};

// Of one object in one state, or of several states together.
class VisibleSurface {
 public:
  static constexpr int kCells = 512;       // of the domain [0, 1]^2, along one dimension
  static constexpr int kCoarseCells = 64;  // likewise
  static constexpr DomainPart kWholeDomain{{0, 0}, {kCoarseCells, kCoarseCells}};

  bool visible() const { return !seen_.empty(); }
  const std::vector<SurfaceSample>& samples() const { return samples_; }
  // Whether coarse cell column `i` of the u (v) dimension meets a triangle of which something is seen.
  bool meets(int dimension, int i) const;
  // What lies in a part of the domain. Where something is seen of that, it has a sample.
  VisibleSurface within(const DomainPart& part) const;
  // Corners of the ends of all rows of seen cells, after a cut along borders of cells that are not seen: their hull holds all
  // that is seen.
  std::vector<glm::vec2> outline(const glm::vec2& cut) const;

  using CellRow = std::bitset<kCells>;
  void see(int row, const CellRow& cells);
  void meet(const glm::vec2& low, const glm::vec2& high);  // a triangle's bounds
  void add_sample(const SurfaceSample& sample) { samples_.push_back(sample); }
  void merge(const VisibleSurface& other);

 private:
  struct Run {
    int16_t row = 0, first = 0, last = 0;  // cells of a row in v
  };
  const SurfaceSample* nearest_sample(const Run& run) const;

  std::vector<SurfaceSample> samples_;
  std::vector<Run> seen_;
  std::array<std::bitset<kCoarseCells>, kCoarseCells> met_;  // rows in v
};

// [state][object]. `options`: picture size and supersampling.
std::vector<std::vector<VisibleSurface>> survey_surfaces(hal::Gpu& gpu, const InferenceOptions& options,
                                                         std::span<const DrawnObject> objects,
                                                         std::span<const GeometryState> states);

}  // namespace vitrine
