// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What every reader of rendering matrices does with what it knows of single supersamples.
#pragma once

#include <array>
#include <functional>

#include "host/infer/rendering_matrix.h"

namespace vitrine {

inline constexpr float kSmallestWeight = 1e-6f;  // below the device's own rounding
inline constexpr size_t kMaxTapEntries = 8;      // texels that one trilinear fetch mixes
inline constexpr size_t kMaxEntries = 4 * kMaxTapEntries;

// The row of one supersample, texels in any order and possibly several times.
struct SampleRow {
  size_t count = 0;  // beyond kMaxEntries: more than there is room for
  std::array<MatrixEntry, kMaxEntries> entries;
  void add(uint32_t texel, float weight) {
    if (!(weight > kSmallestWeight)) return;
    if (count < kMaxEntries) entries[count] = {texel, weight};
    ++count;
  }
};

// The identifier that test renderings carry in their fourth channel: which object a supersample shows, or -1.
inline int object_of(const glm::vec4& identifier) { return static_cast<int>(identifier.w + 0.5f) - 1; }

// `identifiers`: of a supersampled picture of width x height, rows bottom first. `row`: fills the row of the sample with that
// index in it. Throws InputError where a row is not the mean of `taps` trilinear fetches.
StateMatrix assemble_matrix(std::span<const glm::vec4> identifiers, int width, int height, int supersampling, size_t object_count,
                            int taps, const std::function<void(size_t sample, SampleRow& row)>& row);

}  // namespace vitrine
