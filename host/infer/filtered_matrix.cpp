// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/filtered_matrix.h"

#include <algorithm>

#include "host/infer/lanes.h"

namespace vitrine {
namespace {

constexpr int kPad = kMaxResolveTaps;  // zeros at both ends of a row, so that taps need no bounds

int floor_divide(int a, int b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

// Sum of the taps of pixel `pixel` that lie inside the picture.
float tap_sum(const ResolveTaps& taps, int supersampling, int pixel, int pixels) {
  float sum = 0;
  for (int k = 0; k < taps.count; ++k) {
    const int sample = pixel * supersampling + taps.first + k;
    if (sample >= 0 && sample < pixels * supersampling) sum += taps.weight[static_cast<size_t>(k)];
  }
  return sum;
}

}  // namespace

FilteredMatrix::FilteredMatrix(const ObjectMatrix& matrix, int supersampling, int width, int height)
    : matrix_(&matrix), supersampling_(supersampling), taps_(resolve_taps(supersampling)) {
  const auto row_samples = static_cast<uint32_t>(window().width * supersampling);
  const int rows = window().height * supersampling;
  uint32_t at = 0;
  for (int row = 0; row <= rows; ++row) {
    while (at < matrix.samples.size() && matrix.samples[at] < static_cast<uint32_t>(row) * row_samples) ++at;
    row_starts_.push_back(at);
  }
  uint32_t largest = 0;
  for (const MatrixEntry& entry : matrix.entries) largest = std::max(largest, entry.texel);
  const std::vector<float> ones(largest + 1, 1.0f);
  filtered_.resize(pixel_count());
  apply(ones.data(), filtered_.data());
  coverage_.resize(pixel_count());
  for (int y = 0; y < window().height; ++y)
    for (int x = 0; x < window().width; ++x) {
      const size_t p = static_cast<size_t>(y) * static_cast<size_t>(window().width) + static_cast<size_t>(x);
      coverage_[p] = std::min(1.0f, filtered_[p] / (tap_sum(taps_, supersampling, window().x + x, width) *
                                                    tap_sum(taps_, supersampling, window().y + y, height)));
    }
}

// Pixels whose taps meet samples [first, last].
FilteredMatrix::Span FilteredMatrix::pixels_of_samples(int first, int last, int pixel_count) const {
  const int a = floor_divide(first - taps_.first - taps_.count + supersampling_, supersampling_);
  const int b = floor_divide(last - taps_.first, supersampling_);
  return {std::max(0, a), std::min(pixel_count - 1, b)};
}

template <typename T>
void FilteredMatrix::apply_row(int row, const T* texels, T* pixels, T* samples, T* filtered_row) const {
  const uint32_t begin = row_starts_[static_cast<size_t>(row)], end = row_starts_[static_cast<size_t>(row) + 1];
  if (begin == end) return;
  const auto origin = static_cast<uint32_t>(row * window().width * supersampling_);
  const int first = static_cast<int>(matrix_->samples[begin] - origin),
            last = static_cast<int>(matrix_->samples[end - 1] - origin);
  std::fill(samples + first, samples + last + 1 + 2 * kPad, T{});
  for (uint32_t s = begin; s < end; ++s) {
    T sum{};
    for (uint32_t e = matrix_->starts[s]; e < matrix_->starts[s + 1]; ++e)
      sum += matrix_->entries[e].weight * texels[matrix_->entries[e].texel];
    samples[kPad + static_cast<int>(matrix_->samples[s] - origin)] = sum;
  }
  const Span columns = pixels_of_samples(first, last, window().width);
  for (int x = columns.first; x <= columns.last; ++x) {
    const T* taps = samples + kPad + x * supersampling_ + taps_.first;
    T sum{};
    for (int k = 0; k < taps_.count; ++k) sum += taps_.weight[static_cast<size_t>(k)] * taps[k];
    filtered_row[x] = sum;
  }
  const Span rows = pixels_of_samples(row, row, window().height);
  for (int y = rows.first; y <= rows.last; ++y) {
    const float weight = taps_.weight[static_cast<size_t>(row - taps_.first - y * supersampling_)];
    T* out = pixels + static_cast<size_t>(y) * static_cast<size_t>(window().width);
    for (int x = columns.first; x <= columns.last; ++x) out[x] += weight * filtered_row[x];
  }
}

template <typename T>
void FilteredMatrix::apply(const T* texels, T* pixels) const {
  std::fill(pixels, pixels + pixel_count(), T{});
  std::vector<T> samples(static_cast<size_t>(window().width * supersampling_ + 2 * kPad)),
      row(static_cast<size_t>(window().width));
  for (int y = 0; y < window().height * supersampling_; ++y) apply_row(y, texels, pixels, samples.data(), row.data());
}

template <typename T>
void FilteredMatrix::add_row_transposed(int row, const T* pixels, T* texels, T* filtered_row) const {
  const uint32_t begin = row_starts_[static_cast<size_t>(row)], end = row_starts_[static_cast<size_t>(row) + 1];
  if (begin == end) return;
  const auto origin = static_cast<uint32_t>(row * window().width * supersampling_);
  const int first = static_cast<int>(matrix_->samples[begin] - origin),
            last = static_cast<int>(matrix_->samples[end - 1] - origin);
  const Span columns = pixels_of_samples(first, last, window().width);
  const Span rows = pixels_of_samples(row, row, window().height);
  std::fill(filtered_row + columns.first, filtered_row + columns.last + 1, T{});
  for (int y = rows.first; y <= rows.last; ++y) {
    const float weight = taps_.weight[static_cast<size_t>(row - taps_.first - y * supersampling_)];
    const T* in = pixels + static_cast<size_t>(y) * static_cast<size_t>(window().width);
    for (int x = columns.first; x <= columns.last; ++x) filtered_row[x] += weight * in[x];
  }
  for (uint32_t s = begin; s < end; ++s) {
    const int at = static_cast<int>(matrix_->samples[s] - origin) - taps_.first;
    T sum{};
    for (int x = floor_divide(at, supersampling_), k = at - x * supersampling_; k < taps_.count; k += supersampling_, --x)
      if (x >= 0 && x < window().width) sum += taps_.weight[static_cast<size_t>(k)] * filtered_row[x];
    for (uint32_t e = matrix_->starts[s]; e < matrix_->starts[s + 1]; ++e)
      texels[matrix_->entries[e].texel] += matrix_->entries[e].weight * sum;
  }
}

template <typename T>
void FilteredMatrix::add_transposed(const T* pixels, T* texels) const {
  std::vector<T> row(static_cast<size_t>(window().width));
  for (int y = 0; y < window().height * supersampling_; ++y) add_row_transposed(y, pixels, texels, row.data());
}

#define VITRINE_INSTANTIATE(T)                                \
  template void FilteredMatrix::apply<T>(const T*, T*) const; \
  template void FilteredMatrix::add_transposed<T>(const T*, T*) const;
VITRINE_INSTANTIATE(float)
VITRINE_INSTANTIATE(Lanes<1>)
VITRINE_INSTANTIATE(Lanes<2>)
VITRINE_INSTANTIATE(Lanes<3>)
#undef VITRINE_INSTANTIATE

}  // namespace vitrine
