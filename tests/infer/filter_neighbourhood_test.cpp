// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/filter_neighbourhood.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "target/mip.h"

namespace vitrine::testing {
namespace {

using hal::TextureWrap;
constexpr TextureWrap kWraps[] = {TextureWrap::kClampToEdge, TextureWrap::kRepeat};
constexpr int kSteps = 32;  // places tried a texel

std::vector<int> all_levels(int size) {
  std::vector<int> sizes{size};
  while (sizes.back() > 1) sizes.push_back(mip_size(sizes.back()));
  return sizes;
}

int in_row(int texel, int size, TextureWrap wrap) {
  return wrap == TextureWrap::kRepeat ? (texel % size + size) % size : std::clamp(texel, 0, size - 1);
}

// The texels that a sample mixes, as GL defines it, in a row of `size` at place `at` of it, rounded up and down by the `rounding`
// (of a texel) that a device may be off.
std::vector<int> mixed_at(double at, int size, TextureWrap wrap, double rounding) {
  std::vector<int> texels;
  for (const double place : {at * size - 0.5 - rounding, at * size - 0.5 + rounding})
    for (const double texel : {std::floor(place), std::ceil(place)})
      texels.push_back(in_row(static_cast<int>(texel), size, wrap));
  return texels;
}

// Gives every texel in the neighbourhood of a solved texel its number, as the reader does; false where one has two.
bool give_numbers(const std::vector<int>& sizes, int level, int spacing, int first, TextureWrap wrap,
                  std::vector<std::vector<int>>& numbers) {
  const int size = sizes[static_cast<size_t>(level)];
  numbers.clear();
  for (const int other : sizes) numbers.emplace_back(static_cast<size_t>(other), -1);
  for (int texel = first; texel < size; texel += spacing)
    for (int l = std::max(0, level - 1); l <= std::min(level + 1, static_cast<int>(sizes.size()) - 1); ++l) {
      const int other = sizes[static_cast<size_t>(l)];
      const TexelRange range = filter_neighbourhood(texel, size, other, l == level, wrap);
      for (int t = range.first; t <= range.last; ++t) {
        int& number = numbers[static_cast<size_t>(l)][static_cast<size_t>(in_row(t, other, wrap))];
        if (number >= 0 && number != texel) return false;
        number = texel;
      }
    }
  return true;
}

bool any_spacing_below_is_safe(const std::vector<int>& sizes, int level, int spacing, TextureWrap wrap) {
  std::vector<std::vector<int>> numbers;
  for (int smaller = 1; smaller < spacing; ++smaller) {
    bool safe = true;
    for (int first = 0; first < std::min(smaller, sizes[static_cast<size_t>(level)]); ++first)
      safe = safe && give_numbers(sizes, level, smaller, first, wrap, numbers);
    if (safe) return true;
  }
  return false;
}

TEST(FilterNeighbourhood, NoSampleMixesANumberOfAnotherTexelIntoTheOneItReads) {
  for (const TextureWrap wrap : kWraps)
    for (int size = 1; size <= 160; ++size) {
      const std::vector<int> sizes = all_levels(size);
      for (int level = 0; level < std::min(2, static_cast<int>(sizes.size()));
           ++level) {  // coarser ones are those of other sizes
        const int own = sizes[static_cast<size_t>(level)], spacing = safe_spacing(sizes, level, wrap);
        for (int first = 0; first < std::min(spacing, own); ++first) {
          std::vector<std::vector<int>> numbers;
          ASSERT_TRUE(give_numbers(sizes, level, spacing, first, wrap, numbers)) << "size " << size << ", level " << level;
          for (int step = -kSteps; step <= (own + 1) * kSteps; ++step) {
            const double at = static_cast<double>(step) / (own * kSteps);
            for (const int texel : mixed_at(at, own, wrap, 0)) {
              if (texel % spacing != first) continue;
              for (int l = std::max(0, level - 1); l <= std::min(level + 1, static_cast<int>(sizes.size()) - 1); ++l)
                for (const int mixed : mixed_at(at, sizes[static_cast<size_t>(l)], wrap, l == level ? 0 : 1.0 / 64))
                  ASSERT_EQ(numbers[static_cast<size_t>(l)][static_cast<size_t>(mixed)], texel)
                      << "size " << size << ", level " << level << ", other level " << l << ", at " << at;
            }
          }
        }
      }
    }
}

TEST(FilterNeighbourhood, NoSmallerSpacingWouldDo) {
  for (const TextureWrap wrap : kWraps)
    for (int size = 1; size <= 100; ++size) {
      const std::vector<int> sizes = all_levels(size);
      EXPECT_FALSE(any_spacing_below_is_safe(sizes, 0, safe_spacing(sizes, 0, wrap), wrap)) << size;
    }
}

TEST(FilterNeighbourhood, PowersOfTwoAreSolvedEverySixthTexelAndEveryEighthWhereTheyRepeat) {
  for (const int size : {16, 64, 256, 1024}) {
    EXPECT_EQ(safe_spacing(all_levels(size), 0, TextureWrap::kClampToEdge), 6);
    EXPECT_EQ(safe_spacing(all_levels(size), 0, TextureWrap::kRepeat), 8);
  }
}

TEST(FilterNeighbourhood, NoSizeNeedsMoreThanEverySeventhTexelUnlessItRepeats) {
  for (int size = 1; size <= 2048; ++size) EXPECT_LE(safe_spacing(all_levels(size), 0, TextureWrap::kClampToEdge), 7) << size;
}

}  // namespace
}  // namespace vitrine::testing
