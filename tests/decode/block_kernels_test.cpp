// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The decoder's inner loops give what the definitions in formats/node_coding.h do, with every kind of vectors of this machine.
#include "target/decode/block_kernels.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <random>
#include <vector>

namespace vitrine {
namespace {

class BlockKernels : public testing::TestWithParam<int64_t> {
 protected:
  void SetUp() override { hwy::SetSupportedTargetsForTest(GetParam()); }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
  int below(int limit) { return static_cast<int>(random_() % static_cast<unsigned>(limit)); }
  int16_t value(int limit) { return static_cast<int16_t>(below(2 * limit + 1) - limit); }

  std::mt19937 random_{4};
};

constexpr ptrdiff_t kStride = kTileSize + 5;

TEST_P(BlockKernels, ResidualsAreThoseOfTheDefinition) {
  for (int trial = 0; trial < 3000; ++trial) {
    const int log2 = 3 + trial % 3, size = 1 << log2;
    const CoefficientExtent extent{1 + below(trial % 2 ? size : 3), 1 + below(trial % 5 ? size : 2)};
    std::vector<int16_t> coefficients(static_cast<size_t>(extent.even_columns() * extent.even_rows()), 0);
    for (int x = 0; x < extent.columns; ++x)
      for (int y = 0; y < extent.rows; ++y)
        coefficients[static_cast<size_t>(x * extent.even_rows() + y)] = trial % 7 ? value(900) : below(2) ? 32767 : -32768;
    std::vector<int16_t> texels(kTileSize * kStride);
    for (int16_t& texel : texels) texel = value(kNodeValueMax);
    std::vector<int16_t> expected = texels, residual(static_cast<size_t>(size * size));
    invert_transform(coefficients.data(), extent, log2, residual.data());
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        int16_t& texel = expected[static_cast<size_t>(y * kStride + x)];
        texel = static_cast<int16_t>(
            std::clamp(texel + residual[static_cast<size_t>((y << log2) + x)], -kNodeValueMax, kNodeValueMax));
      }
    add_residual(coefficients.data(), extent, log2, texels.data(), kStride);
    ASSERT_EQ(texels, expected) << "size " << size << ", " << extent.columns << " x " << extent.rows;
  }
}

TEST_P(BlockKernels, PredictionsAreThoseOfTheDefinition) {
  for (int trial = 0; trial < 600; ++trial) {
    const int log2 = 3 + trial % 3, size = 1 << log2;
    BlockBorder border;
    border.has_left = trial % 4 != 1;
    border.has_above = trial % 4 != 2;
    for (int16_t& texel : border.left) texel = value(kNodeValueMax);
    for (int16_t& texel : border.above) texel = value(kNodeValueMax);
    for (const Prediction mode : {Prediction::kMean, Prediction::kPlanar, Prediction::kHorizontal, Prediction::kVertical}) {
      std::vector<int16_t> texels(kTileSize * kStride, 77), expected = texels, whole(static_cast<size_t>(size * size));
      predict_from(mode, border, log2, whole.data());
      for (int y = 0; y < size; ++y)
        std::copy_n(&whole[static_cast<size_t>(y << log2)], size, &expected[static_cast<size_t>(y * kStride)]);
      predict_texels(mode, border, log2, texels.data(), kStride);
      ASSERT_EQ(texels, expected) << "size " << size << ", mode " << static_cast<int>(mode);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EveryKindOfVectors, BlockKernels, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& kind) { return std::string(hwy::TargetName(kind.param)); });

}  // namespace
}  // namespace vitrine
