// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/decode_rates.h"

#include <gtest/gtest.h>

#include "host/encode/node_encoder.h"
#include "tests/encode/synthetic.h"

namespace vitrine {
namespace {

// Pictures as an image's nodes carry them, with the bytes that they were coded to.
struct Coded {
  std::vector<NodeCode> codes;
  std::vector<NodePicture> pictures;

  Coded() {
    for (const auto& [width, height] : {std::pair{200, 120}, {97, 64}, {9, 5}}) {
      const CodedPlanes source = synthetic::texture(width, height, {}, {1, 2});
      NodeTask task;
      task.width = width;
      task.height = height;
      task.planes = source;
      task.steps = {400, 900, 700};
      task.weights = {1.0f / 300, 1.0f / 1800, 1.0f / 1200};
      codes.push_back(NodeEncoder().encode(task));
      pictures.push_back({.desc = {width, height, {400, 900, 700}, {}, codes.back().units}, .bytes = {}, .source = source});
    }
    for (size_t i = 0; i < codes.size(); ++i) pictures[i].bytes = std::as_bytes(std::span(codes[i].bytes));
  }
};

TEST(DecodeRates, DesignsAreComparedAtOnePsnr) {
  const Coded coded;
  const DecodeRates rates = measure_decoding(coded.pictures, 2, silent_progress());
  ASSERT_EQ(rates.rows.size(), 4u);
  EXPECT_EQ(rates.nodes, 3u);
  EXPECT_EQ(rates.texels, 200u * 120 + 97 * 64 + 9 * 5);
  EXPECT_EQ(rates.rows[0].coder, "dct");
  EXPECT_EQ(rates.rows[1].coder, "libjpeg-turbo");
  EXPECT_GT(rates.rows[0].psnr_db, 25);
  EXPECT_NEAR(rates.rows[0].psnr_db, rates.rows[1].psnr_db, 0.3);  // quantizers are whole numbers
  EXPECT_GE(rates.rows[1].psnr_db, rates.rows[0].psnr_db - 0.05);
  EXPECT_LT(rates.rows[0].bits_per_texel, rates.rows[1].bits_per_texel);
  EXPECT_EQ(rates.rows[1].relative, 1);
  EXPECT_EQ(rates.rows[2].coder, "spiht");
  EXPECT_NEAR(rates.rows[0].psnr_db, rates.rows[2].psnr_db, 0.3);
  EXPECT_EQ(rates.rows[3].share_of_copy, 1);
  EXPECT_GT(rates.unit_ns, 0);
}

TEST(DecodeRates, FineQuantizersGiveThePicturesThemselvesBack) {
  const Coded coded;
  const auto jpeg = jpeg_design(coded.pictures, 1e-3);
  for (size_t i = 0; i < coded.pictures.size(); ++i) {
    std::vector<std::byte> out(jpeg->decoded_bytes(i));
    jpeg->decode(i, out.data());
    const CodedPlanes planes = jpeg->planes_of(i, out.data());
    const CodedPlanes& source = coded.pictures[i].source;
    ASSERT_EQ(planes.size(), source.size());
    const auto [low, high] = std::minmax_element(source.begin(), source.end());
    const double step = std::max(1.0, (*high - *low) / 254.0);  // of 8 bits
    for (size_t k = 0; k < planes.size(); ++k) ASSERT_NEAR(planes[k], source[k], 3 * step) << k;
  }
}

}  // namespace
}  // namespace vitrine
