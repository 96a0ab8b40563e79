// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/rendering_matrix.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/base/error.h"
#include "host/infer/coordinate_reader.h"
#include "host/infer/eight_bit_reader.h"
#include "host/infer/identifier_reader.h"
#include "host/infer/matrix_assembly.h"

namespace vitrine {
namespace {

constexpr float kSameWeight = 2e-5f;  // two readers agree

// Bounds of an object in supersamples, rows from the top.
struct Bounds {
  int left = INT32_MAX, top = INT32_MAX, right = -1, bottom = -1;
  void include(int x, int y) {
    left = std::min(left, x);
    right = std::max(right, x);
    top = std::min(top, y);
    bottom = std::max(bottom, y);
  }
};

// Output pixels whose filter (radius 1) reaches the bounds, inside the picture.
PixelWindow window_of(const Bounds& bounds, int supersampling, int width, int height) {
  if (bounds.right < 0) return {};
  const int x0 = std::max(0, bounds.left / supersampling - 1), x1 = std::min(width, bounds.right / supersampling + 2);
  const int y0 = std::max(0, bounds.top / supersampling - 1), y1 = std::min(height, bounds.bottom / supersampling + 2);
  return {x0, y0, x1 - x0, y1 - y0};
}

// Sorts by texel and merges what names the same one; the number of entries that remain. By insertion: there are few.
size_t sort_and_merge(std::span<MatrixEntry> entries) {
  size_t count = 0;
  for (const MatrixEntry& entry : entries) {
    size_t at = count;
    while (at > 0 && entries[at - 1].texel > entry.texel) --at;
    if (at > 0 && entries[at - 1].texel == entry.texel) {
      entries[at - 1].weight += entry.weight;
      continue;
    }
    const MatrixEntry own = entry;  // its place is overwritten
    std::copy_backward(entries.begin() + static_cast<ptrdiff_t>(at), entries.begin() + static_cast<ptrdiff_t>(count),
                       entries.begin() + static_cast<ptrdiff_t>(count) + 1);
    entries[at] = own;
    ++count;
  }
  return count;
}

void check_row(const SampleRow& row, int taps) {
  double sum = 0;
  for (size_t i = 0; i < std::min(row.count, kMaxEntries); ++i) sum += static_cast<double>(row.entries[i].weight);
  if (row.count <= static_cast<size_t>(taps) * kMaxTapEntries && std::fabs(sum - 1) < 1e-4) return;
  throw InputError(
      "graphics device",
      fmt::format("a sample mixes {} texels with weights that sum to {:.6f}, not as its filter says", row.count, sum),
      "compile on a device that filters as the specification says (OSMesa does)");
}

}  // namespace

StateMatrix assemble_matrix(std::span<const glm::vec4> identifiers, int width, int height, int supersampling, size_t object_count,
                            int taps, const std::function<void(size_t sample, SampleRow& row)>& row) {
  const auto for_each_sample = [&](const auto& body) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const size_t s = static_cast<size_t>(height - 1 - y) * static_cast<size_t>(width) + static_cast<size_t>(x);
        if (identifiers[s].w > 0.5f) body(x, y, s, static_cast<size_t>(object_of(identifiers[s])));
      }
  };
  std::vector<Bounds> bounds(object_count);
  std::vector<size_t> sample_counts(object_count);
  for_each_sample([&](int x, int y, size_t, size_t object) {
    bounds[object].include(x, y);
    ++sample_counts[object];
  });
  StateMatrix matrix(object_count);
  for (size_t object = 0; object < object_count; ++object) {
    ObjectMatrix& rows = matrix[object];
    rows.window = window_of(bounds[object], supersampling, width / supersampling, height / supersampling);
    rows.samples.reserve(sample_counts[object]);
    rows.starts.reserve(sample_counts[object] + 1);
    rows.starts.push_back(0);
    rows.entries.reserve(sample_counts[object] * kMaxTapEntries);
  }
  for_each_sample([&](int x, int y, size_t s, size_t object) {
    SampleRow own;
    row(s, own);
    check_row(own, taps);
    ObjectMatrix& rows = matrix[object];
    const int left = x - rows.window.x * supersampling, top = y - rows.window.y * supersampling;
    rows.samples.push_back(static_cast<uint32_t>(top * rows.window.width * supersampling + left));
    const size_t count = sort_and_merge({own.entries.data(), own.count});
    rows.entries.insert(rows.entries.end(), own.entries.begin(), own.entries.begin() + static_cast<ptrdiff_t>(count));
    rows.starts.push_back(static_cast<uint32_t>(rows.entries.size()));
  });
  for (ObjectMatrix& rows : matrix) rows.entries.shrink_to_fit();
  return matrix;
}

void TapRows::reset(size_t samples) {
  counts_.assign(samples, 0);
  entries_.resize(samples);
}

void TapRows::add_to(SampleRow& row, size_t sample, float share) const {
  const size_t count = counts_[sample];
  for (size_t i = 0; i < std::min(count, kMaxTapEntries); ++i)
    row.add(entries_[sample][i].texel, share * entries_[sample][i].weight);
  if (count > kMaxTapEntries) row.count += kMaxEntries;
}

StateMatrix assemble_taps(const TestRenderer& renderer, std::span<const glm::vec4> identifiers, size_t object_count,
                          std::span<const TapRows* const> taps) {
  const float share = 1.0f / static_cast<float>(taps.size());
  return assemble_matrix(identifiers, renderer.width(), renderer.height(), renderer.supersampling(), object_count,
                         static_cast<int>(taps.size()), [&](size_t sample, SampleRow& row) {
                           for (const TapRows* tap : taps) tap->add_to(row, sample, share);
                         });
}

namespace {

float row_difference(std::span<const MatrixEntry> a, std::span<const MatrixEntry> b) {
  float largest = 0;
  for (size_t i = 0, j = 0; i < a.size() || j < b.size();) {
    const bool left = j == b.size() || (i < a.size() && a[i].texel <= b[j].texel);
    const bool right = i == a.size() || (j < b.size() && b[j].texel <= a[i].texel);
    largest = std::max(largest, std::fabs((left ? a[i].weight : 0) - (right ? b[j].weight : 0)));
    i += left;
    j += right;
  }
  return largest;
}

std::span<const MatrixEntry> row_of(const ObjectMatrix& matrix, size_t sample) {
  return std::span(matrix.entries).subspan(matrix.starts[sample], matrix.starts[sample + 1] - matrix.starts[sample]);
}

}  // namespace

float largest_difference(const StateMatrix& a, const StateMatrix& b) {
  if (a.size() != b.size()) return std::numeric_limits<float>::infinity();
  float largest = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    if (a[i].samples != b[i].samples) return std::numeric_limits<float>::infinity();
    for (size_t s = 0; s < a[i].samples.size(); ++s)
      largest = std::max(largest, row_difference(row_of(a[i], s), row_of(b[i], s)));
  }
  return largest;
}

MatrixMethod choose_matrix_method(TestRenderer& renderer, std::span<const TextureSize> sizes, const GeometryState& state) {
  if (renderer.format() == hal::TextureFormat::kRgba8) return MatrixMethod::kEightBit;
  const GeometryState* const states[] = {&state};
  const StateMatrix shown = IdentifierReader(renderer, sizes).read(states)[0];
  const bool follows = largest_difference(shown, CoordinateReader(renderer, sizes).read(states)[0]) <= kSameWeight;
  return follows ? MatrixMethod::kCoordinates : MatrixMethod::kIdentifiers;
}

std::unique_ptr<MatrixReader> make_matrix_reader(MatrixMethod method, TestRenderer& renderer,
                                                 std::span<const TextureSize> sizes) {
  switch (method) {
    case MatrixMethod::kCoordinates:
      return std::make_unique<CoordinateReader>(renderer, sizes);
    case MatrixMethod::kEightBit:
      return std::make_unique<EightBitReader>(renderer, sizes);
    case MatrixMethod::kIdentifiers:
      break;
  }
  return std::make_unique<IdentifierReader>(renderer, sizes);
}

}  // namespace vitrine
