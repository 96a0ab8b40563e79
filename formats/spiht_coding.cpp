// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/spiht_coding.h"

#include <algorithm>

namespace vitrine {
namespace {

constexpr uint32_t kLeastBandStep = 4;
constexpr int kRootsAcross = 4;  // halvings end where the longer side of the low band is at most this

// 65536 over the norm of a basis function of one dimension after k halvings.
constexpr std::array<uint32_t, kMaxWaveletLevels + 1> kInverseLow = {65536, 51165, 36580, 25888, 18307, 12945, 9153};
constexpr std::array<uint32_t, kMaxWaveletLevels + 1> kInverseHigh = {0, 80983, 67796, 48929, 34654, 24507, 17329};

// Trained on the residuals of a scene's textures at about 0.1 bit a texel.
constexpr std::array<uint8_t, kSpihtContextCount> kDefaultContexts = {
    220, 220, 172, 148, 112, 128, 124, 220, 136, 220, 128, 97,  97,  97,  97,  179, 168, 132, 116, 112, 140, 139,
    97,  220, 97,  97,  97,  97,  97,  97,  95,  114, 120, 95,  105, 108, 97,  112, 138, 119, 122, 134, 96,  113,
    141, 119, 121, 133, 90,  108, 128, 119, 118, 138, 50,  70,  72,  93,  85,  108, 98,  113, 129, 131, 127, 143,
    97,  97,  97,  252, 252, 252, 112, 124, 136, 101, 122, 137, 97,  97,  97,  244, 236, 232, 108, 121, 132, 99,
    117, 142, 98,  105, 114, 122, 131, 111, 110, 123, 127, 131, 106, 114, 130, 131, 139, 130, 131, 142, 139, 147,
    98,  107, 119, 127, 131, 106, 115, 123, 127, 130, 94,  110, 118, 122, 130, 102, 114, 119, 123, 131, 88,  97,
    103, 107, 120, 81,  67,  97,  100, 112, 97,  105, 119, 111, 108, 108, 102, 116, 122, 120, 112, 119, 124, 133,
    131, 113, 119, 122, 121, 128, 126, 126, 133, 131, 142, 137, 131, 141, 134, 146, 93,  107, 119, 89,  96,  113};

// Halvings that did something along a dimension, up to level k.
int halvings(const std::array<int, kMaxWaveletLevels + 1>& size, int level) {
  int n = 0;
  while (n < level && size[static_cast<size_t>(n)] > 1) ++n;
  return n;
}

}  // namespace

SpihtLayout spiht_layout(int width, int height) {
  SpihtLayout layout;
  layout.width[0] = width;
  layout.height[0] = height;
  while (layout.levels < kMaxWaveletLevels && std::max(width, height) > kRootsAcross) {
    width = (width + 1) / 2;
    height = (height + 1) / 2;
    const size_t k = static_cast<size_t>(++layout.levels);
    layout.width[k] = width;
    layout.height[k] = height;
    layout.first_cell[k] = layout.map_cells + static_cast<size_t>(width) + 3;  // past the border's first row and cell
    layout.map_cells += (static_cast<size_t>(width) + 2) * (static_cast<size_t>(height) + 2);
  }
  return layout;
}

size_t spiht_scratch_words(int width, int height) {
  const SpihtLayout layout = spiht_layout(width, height);
  return kNodePlanes * layout.map_cells + layout.texels();
}

bool load_spiht_contexts(std::span<const uint8_t> bytes, SpihtContextSet& contexts) {
  if (bytes.empty()) bytes = default_spiht_context_bytes();
  if (bytes.size() != kSpihtContextCount) return false;
  for (size_t i = 0; i < bytes.size(); ++i) contexts[i] = adaptive_bit_from_byte(bytes[i]);
  return true;
}

std::span<const uint8_t> default_spiht_context_bytes() { return kDefaultContexts; }

uint32_t band_scale(const SpihtLayout& layout, int level, int orientation) {
  const size_t k = static_cast<size_t>(level);
  const size_t across = static_cast<size_t>(halvings(layout.width, level)),
               down = static_cast<size_t>(halvings(layout.height, level));
  const bool high_across = orientation == kHorizontalDetail || orientation == kDiagonalDetail;
  const bool high_down = orientation == kVerticalDetail || orientation == kDiagonalDetail;
  const uint64_t x = high_across ? kInverseHigh[k] : kInverseLow[across], y = high_down ? kInverseHigh[k] : kInverseLow[down];
  return static_cast<uint32_t>((x * y) >> 16);
}

uint32_t band_step(const SpihtLayout& layout, int level, int orientation, uint16_t step) {
  const uint64_t scaled = (static_cast<uint64_t>(step) * band_scale(layout, level, orientation)) >> 16;
  return std::max(kLeastBandStep, static_cast<uint32_t>(scaled));
}

}  // namespace vitrine
