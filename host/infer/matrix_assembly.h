// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What every reader of rendering matrices does with what it knows of single supersamples.
#pragma once

#include <algorithm>
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

// What one tap mixes at every supersample of a picture, texel by texel as renderings come in.
class TapRows {
 public:
  void reset(size_t samples);
  // From several threads at once for different samples.
  void add(size_t sample, uint32_t texel, float weight) {
    const uint8_t count = counts_[sample]++;
    if (count < kMaxTapEntries) entries_[sample][count] = {texel, weight};  // more of them is reported by assemble_taps
  }
  std::span<MatrixEntry> entries(size_t sample) {
    return std::span(entries_[sample]).first(std::min<size_t>(counts_[sample], kMaxTapEntries));
  }
  // Adds `share` of them to a row.
  void add_to(SampleRow& row, size_t sample, float share) const;

 private:
  std::vector<uint8_t> counts_;
  std::vector<std::array<MatrixEntry, kMaxTapEntries>> entries_;
};

// The identifier that test renderings carry in their fourth channel: which object a supersample shows, or -1.
inline int object_of(const glm::vec4& identifier) { return static_cast<int>(identifier.w + 0.5f) - 1; }

// `identifiers`: of a supersampled picture of width x height, rows bottom first. `row`: fills the row of the sample with that
// index in it. Throws InputError where a row is not the mean of `taps` trilinear fetches.
StateMatrix assemble_matrix(std::span<const glm::vec4> identifiers, int width, int height, int supersampling, size_t object_count,
                            int taps, const std::function<void(size_t sample, SampleRow& row)>& row);
// The mean of all taps, of a picture as `renderer` draws it.
StateMatrix assemble_taps(const TestRenderer& renderer, std::span<const glm::vec4> identifiers, size_t object_count,
                          std::span<const TapRows* const> taps);

}  // namespace vitrine
