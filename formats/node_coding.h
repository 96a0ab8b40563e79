// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What the encoder and the decoder of DCT nodes share: block sizes, the entropy coder's contexts, prediction from
// neighbours, the integer inverse transform, and the units of work. formats/NODE_CODING.md describes the bitstream and is
// normative; the syntax itself is formats/node_syntax.h.
//
// A node is a picture of three planes (Y, Co, Cg). It is coded in tiles of 32 x 32 texels, each a quadtree of square blocks
// of 32, 16 or 8 texels; a block is predicted from texels above and to the left of it (or from zero), and the rest is
// transformed, quantized and coded by an adaptive binary range coder.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace vitrine {

inline constexpr int kNodePlanes = 3;
inline constexpr int kTileSize = 32;  // texels a side
inline constexpr int kTileLog2 = 5;
inline constexpr int kMinBlockLog2 = 3;  // blocks of 8, 16 and 32
inline constexpr int kCellSize = 8;      // granularity of the block flags
inline constexpr int kTileCells = kTileSize / kCellSize;
inline constexpr int kMaxNodeSize = 8192;  // texels a side
// Decoded values lie in [-kNodeValueMax, kNodeValueMax], so sums of up to eight nodes fit 16 bits; those of more, which only odd images have, wrap.
inline constexpr int kNodeValueMax = 4095;
inline constexpr int kStepUnitsPerCode = 8;  // quantizer steps are given in eighths of a code
inline constexpr int kMaxCoefficientLevel = 32767;

// Block flags, one byte per 8 x 8 cell; contexts look at those of the cell to the left and the cell above.
enum BlockFlag : uint8_t {
  kFlagSkipped = 1,    // nothing coded: all zero
  kFlagPredicted = 2,  // predicted from neighbours
  kFlagCoded0 = 4,     // bit 2 + plane: that plane has coefficients
  kFlagSizeShift = 5,  // bits 5..6: log2 of the block's size - 3
};
inline constexpr uint8_t kOutsideFlags = kFlagSkipped | (2 << kFlagSizeShift);

enum class Prediction : uint8_t { kZero, kMean, kPlanar, kHorizontal, kVertical };
inline constexpr int kPredictionCount = 5;

// ---- contexts ----

inline constexpr int kContextSkip = 0;                             // 3 sizes x 3 neighbours
inline constexpr int kContextSplit = kContextSkip + 9;             // 2 sizes x 3 neighbours
inline constexpr int kContextPredicted = kContextSplit + 6;        // 3 sizes x 3 neighbours
inline constexpr int kContextMode = kContextPredicted + 9;         // 3 nodes of the tree of modes
inline constexpr int kContextCoded = kContextMode + 3;             // Y 3 sizes x 3, Co 2 x 3, Cg 2 x 3 neighbours
inline constexpr int kContextLast = kContextCoded + 21;            // luma, chroma: 5 + 7 + 9 prefix bins
inline constexpr int kContextSignificant = kContextLast + 42;      // luma 2 sizes x 3 bands x 5, chroma 2 bands x 5
inline constexpr int kContextAboveOne = kContextSignificant + 40;  // luma 3 bands x 5, chroma 5
inline constexpr int kContextAboveTwo = kContextAboveOne + 20;     // luma 5, chroma 5
inline constexpr int kContextCount = kContextAboveTwo + 10;
inline constexpr int kContextBytesPerLevel = kContextCount;  // one byte a context

// Probability, in 1/65536, that a context's symbol is 1; the mean of a fast and a slow estimate.
struct AdaptiveBit {
  uint16_t fast = 32768, slow = 32768;
  uint8_t fast_shift = 4, slow_shift = 6;

  // In 1/32768, kept away from 0 and 1.
  uint32_t probability_of_one() const {
    const uint32_t p = (static_cast<uint32_t>(fast) + slow) >> 2;
    return p < kMinProbability ? kMinProbability : p > 32768 - kMinProbability ? 32768 - kMinProbability : p;
  }
  void update(bool bit) {
    fast = static_cast<uint16_t>(bit ? fast + ((65535 - fast) >> fast_shift) : fast - (fast >> fast_shift));
    slow = static_cast<uint16_t>(bit ? slow + ((65535 - slow) >> slow_shift) : slow - (slow >> slow_shift));
  }
  static constexpr uint32_t kMinProbability = 20;
};

// An initial state in one byte: upper six bits the probability (on a logistic scale), lower two the speed of adaptation.
AdaptiveBit adaptive_bit_from_byte(uint8_t byte);
inline constexpr int kInitialProbabilities = 64, kAdaptationSpeeds = 4;

using ContextSet = std::array<AdaptiveBit, kContextCount>;
// `bytes`: kContextBytesPerLevel of them, or none for the built-in states. False when there is another number of them.
bool load_contexts(std::span<const uint8_t> bytes, ContextSet& contexts);
// The built-in states, as bytes.
std::span<const uint8_t> default_context_bytes();

// ---- coefficients ----

struct ScanPosition {
  uint8_t x, y;
};
// Diagonals from the lowest frequency, each from its lower left to its upper right; log2 = 3, 4 or 5.
std::span<const ScanPosition> scan_order(int log2);
// Inverse of scan_order.
int scan_index(int log2, int x, int y);

// One plane's quantized coefficients in a block; two columns and rows of zeros follow, for the contexts of neighbours.
struct CoefficientLevels {
  static constexpr int kStride = kTileSize + 2;
  std::array<int16_t, kStride * kStride> value{};  // zero outside `nonzero`
  std::array<ScanPosition, kTileSize * kTileSize> nonzero;
  int nonzero_count = 0;
  int last = 0;  // scan index of the last nonzero coefficient

  int16_t& at(int x, int y) { return value[static_cast<size_t>(y) * kStride + x]; }
  int16_t at(int x, int y) const { return value[static_cast<size_t>(y) * kStride + x]; }
  void clear() {
    for (int i = 0; i < nonzero_count; ++i) at(nonzero[i].x, nonzero[i].y) = 0;
    nonzero_count = 0;
    last = 0;
  }
};

// The basis of the 32-point transform, in 1/64 of sqrt(32) times orthonormal; that of N points is every (32/N)-th row,
// first N columns (ITU-T H.265, 8.6.4.2).
const std::array<std::array<int16_t, kTileSize>, kTileSize>& transform_basis();

// Dequantizes and inverts: `residual` gets size x size values, rows after one another. Any levels and step are safe.
void reconstruct_residual(const CoefficientLevels& levels, int log2, uint16_t step, int16_t* residual);

// ---- prediction ----

// A plane that is being filled, tile by tile.
struct NodePlane {
  int16_t* data;
  int width, height;
};
// Predicts the block whose first texel is (x, y), inside the plane, into size x size values. What lies outside the plane or
// was not decoded yet is never read.
void predict_block(Prediction mode, const NodePlane& plane, int x, int y, int log2, int16_t* prediction);
// prediction + residual (or prediction alone where residual is null), clamped, into the part of the block inside the plane.
void store_block(const int16_t* prediction, const int16_t* residual, const NodePlane& plane, int x, int y, int log2);
void store_zero_block(const NodePlane& plane, int x, int y, int log2);

// ---- units ----

inline constexpr uint64_t kUnitsPerTile = 128;  // each tile, empty ones too
inline constexpr uint64_t kUnitsPerSymbol = 8;  // each binary symbol, adaptive or raw
// Each block that is not skipped, and is `predicted`, three planes.
inline constexpr uint64_t units_of_block(int log2, bool predicted) {
  return (predicted ? 48u : 24u) + ((predicted ? 3u : 1u) << (2 * log2)) / 2;
}
// Each plane with coefficients, the highest of which lie in column `columns` - 1 and row `rows` - 1.
inline constexpr uint64_t units_of_transform(int log2, int columns, int rows) {
  const uint64_t size = 1u << log2;
  return 32 + ((size * static_cast<uint64_t>(columns) * (static_cast<uint64_t>(rows) + size)) >> 3) + size * size / 2;
}
uint64_t units_of_transform(const CoefficientLevels& levels, int log2);

}  // namespace vitrine
