// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/node_coding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "formats/node_syntax.h"

namespace vitrine {
namespace {

TEST(NodeCoding, ScanVisitsEveryFrequencyOnceAndIndexUndoesIt) {
  for (int log2 = 3; log2 <= 5; ++log2) {
    const auto scan = scan_order(log2);
    ASSERT_EQ(scan.size(), size_t{1} << (2 * log2));
    std::set<int> seen;
    for (size_t i = 0; i < scan.size(); ++i) {
      EXPECT_EQ(scan_index(log2, scan[i].x, scan[i].y), static_cast<int>(i));
      seen.insert(scan[i].y * 32 + scan[i].x);
      const size_t before = i > 0 ? i - 1 : 0;
      EXPECT_GE(scan[i].x + scan[i].y, scan[before].x + scan[before].y);
    }
    EXPECT_EQ(seen.size(), scan.size());
  }
}

// The definition of the transform, in double: an orthonormal DCT-II.
std::vector<double> reference_inverse(const CoefficientLevels& levels, int log2, double step) {
  const int n = 1 << log2;
  std::vector<double> out(static_cast<size_t>(n * n), 0);
  const auto basis = [&](int k, int x) {
    return std::sqrt((k == 0 ? 1.0 : 2.0) / n) * std::cos((2 * x + 1) * k * std::numbers::pi / (2 * n));
  };
  for (int ky = 0; ky < n; ++ky) {
    for (int kx = 0; kx < n; ++kx) {
      if (levels.at(kx, ky) == 0) continue;
      for (int y = 0; y < n; ++y) {
        for (int x = 0; x < n; ++x)
          out[static_cast<size_t>(y * n + x)] += levels.at(kx, ky) * step / kStepUnitsPerCode * basis(kx, x) * basis(ky, y);
      }
    }
  }
  return out;
}

void set_level(CoefficientLevels& levels, int x, int y, int value) {
  levels.at(x, y) = static_cast<int16_t>(value);
  levels.nonzero[static_cast<size_t>(levels.nonzero_count++)] = {static_cast<uint8_t>(x), static_cast<uint8_t>(y)};
}

// The integer transform differs from the real one by its rounding (1/16 code a coefficient and a column) and by that of its
// basis, which is below 0.8 % of the amplitude.
TEST(NodeCoding, InverseTransformIsADctToWithinItsRounding) {
  std::mt19937 random(1);
  for (int log2 = 3; log2 <= 5; ++log2) {
    const int n = 1 << log2;
    for (int trial = 0; trial < 20; ++trial) {
      CoefficientLevels levels;
      const uint16_t step = static_cast<uint16_t>(40 + random() % 400);
      std::set<int> used;
      for (int i = 0; i < 1 + trial; ++i) {
        const int at = static_cast<int>(random() % static_cast<unsigned>(n * n));
        if (used.insert(at).second) set_level(levels, at % n, at / n, static_cast<int>(random() % 21) - 10);
      }
      std::vector<int16_t> out(static_cast<size_t>(n * n));
      reconstruct_residual(levels, log2, step, out.data());
      const std::vector<double> expected = reference_inverse(levels, log2, step);
      double amplitude = 0;
      for (const double e : expected) amplitude = std::max(amplitude, std::fabs(e));
      for (size_t i = 0; i < out.size(); ++i)
        EXPECT_NEAR(out[i], expected[i], 1.5 + 0.02 * amplitude) << "log2 " << log2 << " at " << i;
    }
  }
}

TEST(NodeCoding, WildestCoefficientsStayInRange) {
  for (int log2 = 3; log2 <= 5; ++log2) {
    const int n = 1 << log2;
    CoefficientLevels levels;
    for (int i = 0; i < n * n; ++i) set_level(levels, i % n, i / n, i % 3 ? 32767 : -32767);
    std::vector<int16_t> residual(static_cast<size_t>(n * n)), plane(residual.size());
    reconstruct_residual(levels, log2, 65535, residual.data());
    store_block(residual.data(), residual.data(), {plane.data(), n, n}, 0, 0, log2);
    for (const int16_t v : plane) EXPECT_LE(std::abs(static_cast<int>(v)), kNodeValueMax);
  }
}

TEST(NodeCoding, PredictionsContinueWhatTheyArePredictedFrom) {
  // A plane that is linear in x and y is predicted by H or V where it does not change, and exactly if constant by all.
  const int w = 40, h = 40;
  std::vector<int16_t> constant(w * h, 321), prediction(32 * 32);
  const NodePlane plane{constant.data(), w, h};
  for (const Prediction mode : {Prediction::kMean, Prediction::kPlanar, Prediction::kHorizontal, Prediction::kVertical}) {
    for (const auto& [x, y] : {std::pair{32, 32}, {8, 0}, {0, 8}}) {
      predict_block(mode, plane, x, y, 3, prediction.data());
      for (int i = 0; i < 64; ++i) EXPECT_EQ(prediction[static_cast<size_t>(i)], 321);
    }
  }
  std::vector<int16_t> columns(w * h);
  for (int i = 0; i < w * h; ++i) columns[static_cast<size_t>(i)] = static_cast<int16_t>(10 * (i % w));
  predict_block(Prediction::kVertical, {columns.data(), w, h}, 8, 8, 4, prediction.data());
  for (int i = 0; i < 256; ++i) EXPECT_EQ(prediction[static_cast<size_t>(i)], 10 * (8 + i % 16));
}

// Counts raw and adaptive symbols and remembers them, to be read back.
struct Tape {
  std::vector<bool> symbols;
  size_t at = 0;
  bool reading = false;
  bool raw(bool value) {
    if (reading) return symbols[at++];
    symbols.push_back(value);
    return value;
  }
  bool bit(int context, bool value) {
    EXPECT_GE(context, 0);
    EXPECT_LT(context, kContextCount);
    return raw(value);
  }
};

TEST(NodeCoding, EveryMagnitudeAndPlaceSurvivesTheSyntax) {
  for (int rice = 0; rice <= 4; ++rice) {
    for (int value = 0; value <= kMaxCoefficientLevel - 3; value += 1 + value / 40) {
      Tape tape;
      code_escape(tape, rice, value);
      tape.reading = true;
      EXPECT_EQ(code_escape(tape, rice, 0), value);
      EXPECT_EQ(tape.at, tape.symbols.size());
    }
  }
  for (int log2 = 3; log2 <= 5; ++log2) {
    for (int last = 0; last < 1 << (2 * log2); ++last) {
      Tape tape;
      code_last(tape, log2, last % 3, last);
      tape.reading = true;
      EXPECT_EQ(code_last(tape, log2, last % 3, 0), last);
    }
  }
}

TEST(NodeCoding, InitialStatesSpanTheProbabilitiesEvenly) {
  for (int i = 1; i < kInitialProbabilities; ++i) {
    EXPECT_GT(adaptive_bit_from_byte(static_cast<uint8_t>(i << 2)).slow,
              adaptive_bit_from_byte(static_cast<uint8_t>((i - 1) << 2)).slow);
  }
  for (int byte = 0; byte < 256; ++byte) {
    AdaptiveBit state = adaptive_bit_from_byte(static_cast<uint8_t>(byte));
    for (int i = 0; i < 5000; ++i) state.update(true);
    EXPECT_LT(state.probability_of_one(), 32768u);
    for (int i = 0; i < 5000; ++i) state.update(false);
    EXPECT_GT(state.probability_of_one(), 0u);
  }
}

}  // namespace
}  // namespace vitrine
