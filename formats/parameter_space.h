// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The parameter space: the lattice of all axes at which the host renders ground truth, and the positions between.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace vitrine {

inline constexpr int kMaxAxes = 4;
inline constexpr int kMaxCorners = 1 << kMaxAxes;

enum class AxisKind : uint8_t {
  kLinear,    // samples at k / (samples - 1), both ends included
  kPeriodic,  // samples at k / samples; position 1 is position 0
  kDiscrete,  // samples at k / (samples - 1); nothing lies between two samples, values are never averaged
};

struct AxisShape {
  AxisKind kind = AxisKind::kLinear;
  int samples = 1;  // >= 1
};

// One sample: an index per axis, each in [0, samples). Entries at and beyond axis_count are 0.
using GridIndex = std::array<int, kMaxAxes>;
// A position: a number in [0, 1] per axis (see AxisKind). Entries at and beyond axis_count are 0.
using Position = std::array<float, kMaxAxes>;
// A set of axes: bit a is axis a.
using AxisMask = uint32_t;

struct ParameterSpace {
  int axis_count = 0;  // 0..kMaxAxes; with 0 axes the space is a single sample
  std::array<AxisShape, kMaxAxes> axes{};

  // Samples in the whole grid.
  int64_t sample_count() const;
  // Row-major number of a sample, the last axis fastest; and back.
  int64_t flat_from_index(const GridIndex& index) const;
  GridIndex index_from_flat(int64_t flat) const;
  // Where a sample lies.
  Position position_of(const GridIndex& index) const;
  // The sample nearest to a position (periodic axes wrap); positions are clamped to [0, 1] first, NaN counts as 0.
  GridIndex nearest_sample(const Position& position) const;
  // A position in units of samples along one axis: [0, samples - 1], or [0, samples) where it is periodic.
  float sample_coordinate(int axis, float position) const;
  // The same space with every axis outside `mask` reduced to one sample (fields that do not depend on an axis).
  ParameterSpace restricted(AxisMask mask) const;
};

// One of the samples around a position and its multilinear weight.
struct Corner {
  GridIndex index{};
  float weight = 0;
};

// The 2^d samples around a position with weights > 0 that sum to 1 (discrete axes contribute their nearest sample).
// Returns how many of `out` were written. Ordered by flat index, so that sums are deterministic.
int corners_around(const ParameterSpace& space, const Position& position, std::array<Corner, kMaxCorners>& out);

}  // namespace vitrine
