// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The rendering matrix after antialiasing (Hakura 2001, section 3.4.4): rows of the supersampled matrix are filtered with
// the filter of the target's own resolve pass; a row of an output pixel is then divided by the object's filtered coverage,
// so that an object's texture is compared with the object's own layer. The filter is applied as an operator, row of
// supersamples by row of supersamples; filtered rows are never stored.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "host/infer/rendering_matrix.h"
#include "target/draw/resolve.h"

namespace vitrine {

class FilteredMatrix {
 public:
  FilteredMatrix() = default;
  // Keeps a reference to `matrix`. `width`, `height`: of the picture in output pixels.
  FilteredMatrix(const ObjectMatrix& matrix, int supersampling, int width, int height);

  const PixelWindow& window() const { return matrix_->window; }
  size_t pixel_count() const { return static_cast<size_t>(window().width) * static_cast<size_t>(window().height); }

  // pixels = F A texels, over the window, not yet divided by the filtered coverage. `texels`: the whole pyramid.
  template <typename T>
  void apply(const T* texels, T* pixels) const;
  // texels += A' F' pixels.
  template <typename T>
  void add_transposed(const T* pixels, T* texels) const;

  // The row of F A of pixel (x, y) of the window, one supersample's texel after the other; a texel can come several times.
  template <typename Visitor>
  void visit_row(int x, int y, const Visitor& visit) const {
    const int row_samples = window().width * supersampling_, left = x * supersampling_ + taps_.first;
    for (int j = 0; j < taps_.count; ++j) {
      const int row = y * supersampling_ + taps_.first + j;
      if (row < 0 || row >= window().height * supersampling_) continue;
      const auto from = static_cast<uint32_t>(row * row_samples + std::max(0, left));
      const auto to = static_cast<uint32_t>(row * row_samples + std::min(row_samples, left + taps_.count));
      for (size_t s = first_sample(row, from); s < matrix_->samples.size() && matrix_->samples[s] < to; ++s) {
        const auto k = static_cast<size_t>(static_cast<int>(matrix_->samples[s]) - row * row_samples - left);
        const float weight = taps_.weight[static_cast<size_t>(j)] * taps_.weight[k];
        for (uint32_t e = matrix_->starts[s]; e < matrix_->starts[s + 1]; ++e)
          visit(matrix_->entries[e].texel, weight * matrix_->entries[e].weight);
      }
    }
  }

  // F A 1 per pixel of the window: what a row is divided by; and as a share of the pixel, 0..1 (they differ at the
  // picture's border, where the filter is cut off).
  const std::vector<float>& filtered() const { return filtered_; }
  const std::vector<float>& coverage() const { return coverage_; }

 private:
  struct Span {
    int first = 0, last = -1;
  };
  // The first sample at `place` of the window or after it, in row `row` of supersamples or after it.
  size_t first_sample(int row, uint32_t place) const {
    const auto begin = matrix_->samples.begin();
    return static_cast<size_t>(std::lower_bound(begin + row_starts_[static_cast<size_t>(row)],
                                                begin + row_starts_[static_cast<size_t>(row) + 1], place) -
                               begin);
  }
  Span pixels_of_samples(int first, int last, int pixel_count) const;
  template <typename T>
  void apply_row(int row, const T* texels, T* pixels, T* samples, T* filtered_row) const;
  template <typename T>
  void add_row_transposed(int row, const T* pixels, T* texels, T* filtered_row) const;

  const ObjectMatrix* matrix_ = nullptr;
  int supersampling_ = 1;
  ResolveTaps taps_;
  std::vector<uint32_t> row_starts_;  // into matrix_->samples, per row of supersamples
  std::vector<float> filtered_, coverage_;
};

}  // namespace vitrine
