// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What the encoder and the decoder of SPIHT nodes share: the wavelet's bands at any size, the map of cells, the contexts, the
// quantizer and the units of work. formats/SPIHT_CODING.md describes the bitstream and is normative; the order of symbols is
// formats/spiht_syntax.h, the wavelet itself formats/wavelet.h.
//
// A node is a picture of three planes (Y, Co, Cg). Each is split by an integer wavelet; its coefficients are coded bit plane
// by bit plane, all planes of the picture interleaved, along trees of cells (Said and Pearlman 1996). What is significant
// stands in a map of fixed size instead of lists (Wheeler and Pearlman 2000).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/node_coding.h"

namespace vitrine {

inline constexpr int kMaxWaveletLevels = 6;
inline constexpr int kMaxBitPlanes = 15;  // of a coefficient's magnitude

enum Orientation { kHorizontalDetail, kVerticalDetail, kDiagonalDetail };
inline constexpr int kOrientations = 3;

// A cell of level k >= 1 stands for 2^k x 2^k texels: three coefficients, one of each orientation (fewer at far edges), and
// four cells of level k - 1. The map of a plane holds every level's cells with a border of one cell that stays empty.
struct SpihtLayout {
  int levels = 0;                                            // halvings
  std::array<int, kMaxWaveletLevels + 1> width{}, height{};  // of the low band after k halvings; cells of level k
  std::array<size_t, kMaxWaveletLevels + 1> first_cell{};    // of level k in the map: cell (0, 0)
  size_t map_cells = 0;                                      // of one plane

  size_t stride(int level) const { return static_cast<size_t>(width[static_cast<size_t>(level)]) + 2; }
  size_t cell(int level, int x, int y) const {
    return first_cell[static_cast<size_t>(level)] + static_cast<size_t>(y) * stride(level) + static_cast<size_t>(x);
  }
  size_t texels() const { return static_cast<size_t>(width[0]) * static_cast<size_t>(height[0]); }
  // Whether the cell has a coefficient of that orientation.
  bool has(int level, int x, int y, int orientation) const {
    const size_t k = static_cast<size_t>(level);
    return (orientation == kVerticalDetail || x < width[k - 1] - width[k]) &&
           (orientation == kHorizontalDetail || y < height[k - 1] - height[k]);
  }
  // Its place in the plane: low bands top left, detail right of, below, and diagonally below them.
  size_t coefficient(int level, int x, int y, int orientation) const {
    const size_t k = static_cast<size_t>(level);
    const int column = x + (orientation == kVerticalDetail ? 0 : width[k]),
              row = y + (orientation == kHorizontalDetail ? 0 : height[k]);
    return static_cast<size_t>(row) * static_cast<size_t>(width[0]) + static_cast<size_t>(column);
  }
};
// width, height: 1..kMaxNodeSize.
SpihtLayout spiht_layout(int width, int height);
// 16-bit words that a reader needs beside the planes: the maps of the three and one plane of samples; about 2.1 a texel.
size_t spiht_scratch_words(int width, int height);

// A cell in the map: bits 0, 4, 8: the coefficient of that orientation is significant; 12: something in the cell or below
// it is; 13: something below it is.
inline constexpr uint16_t kCellCoefficients = 0x111, kCellSet = 0x1000, kCellDescendants = 0x2000;

// ---- contexts ----

inline constexpr int kSpihtContextPlanes = 0;                           // chroma 2 x position in the prefix 15
inline constexpr int kSpihtContextLow = kSpihtContextPlanes + 30;       // chroma 2 x neighbours 3
inline constexpr int kSpihtContextSet = kSpihtContextLow + 6;           // luma 3 levels, chroma 2; x born 2 x neighbours 3
inline constexpr int kSpihtContextDescendants = kSpihtContextSet + 30;  // chroma 2 x own 2 x born 2 x neighbours 3
inline constexpr int kSpihtContextSignificant = kSpihtContextDescendants + 24;  // 4 kinds x born 2 x parent 2 x neighbours 5
inline constexpr int kSpihtContextRefine = kSpihtContextSignificant + 80;       // chroma 2 x first 2 + later
inline constexpr int kSpihtContextCount = kSpihtContextRefine + 6;

// Of a coefficient, by its significant neighbours in the same band: two for each at a side, one for each at a corner.
inline constexpr int neighbour_class(uint32_t weight) { return weight < 3 ? static_cast<int>(weight) : weight < 5 ? 3 : 4; }

using SpihtContextSet = std::array<AdaptiveBit, kSpihtContextCount>;
// As load_contexts and default_context_bytes of the DCT coder.
bool load_spiht_contexts(std::span<const uint8_t> bytes, SpihtContextSet& contexts);
std::span<const uint8_t> default_spiht_context_bytes();

// ---- quantizer ----

inline constexpr int kWaveletFraction = 1;  // fractional bits of coefficients, on the scale of texels
inline constexpr int kMaxCoefficient = 16383;
// 65536 over the norm of the band's basis functions. Level `layout.levels` and orientation -1: the low band.
uint32_t band_scale(const SpihtLayout& layout, int level, int orientation);
// Quantizer step of a band in 1/8 code: the plane's step times the band's scale, but not below half a code.
uint32_t band_step(const SpihtLayout& layout, int level, int orientation, uint16_t step);
inline int16_t dequantize(uint32_t magnitude, bool negative, uint32_t band_step) {
  const uint64_t scaled = (static_cast<uint64_t>(magnitude) * band_step + (4 >> kWaveletFraction)) >> (3 - kWaveletFraction);
  const int value = scaled < kMaxCoefficient ? static_cast<int>(scaled) : kMaxCoefficient;
  return static_cast<int16_t>(negative ? -value : value);
}

// ---- units ----

inline constexpr uint64_t kSpihtUnitsPerSymbol = 14;  // each binary symbol, adaptive or raw
inline constexpr uint64_t spiht_units_of_clearing(int width) {
  return 8 + static_cast<uint64_t>(width) / 8;
}  // a row of the node
// Each row of the two passes of a level, `samples` long.
inline constexpr uint64_t spiht_units_of_columns(int samples) { return 8 + static_cast<uint64_t>(samples) / 4; }
inline constexpr uint64_t spiht_units_of_line(int samples) { return 8 + static_cast<uint64_t>(samples) / 4; }

}  // namespace vitrine
