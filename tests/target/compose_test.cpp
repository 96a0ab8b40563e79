// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/compose.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <random>
#include <vector>

#include "formats/color.h"
#include "target/mip.h"

namespace vitrine {
namespace {

TEST(Compose, HalvesAreRoundedAsTheReferenceDoes) {
  std::vector<float> values;
  for (int half = 0; half < 0x7bff; ++half) {  // every half, the midpoint to the next, and the floats beside it
    const float low = float_from_half(static_cast<uint16_t>(half)), high = float_from_half(static_cast<uint16_t>(half + 1)),
                middle = (low + high) / 2;
    for (const float value :
         {low, std::nextafterf(low, high), std::nextafterf(middle, low), middle, std::nextafterf(middle, high)})
      values.push_back(value);
  }
  std::vector<uint16_t> halves(values.size());
  halves_from_floats(values, halves.data());
  for (size_t i = 0; i < values.size(); ++i) ASSERT_EQ(halves[i], half_from_float(values[i])) << values[i];
}

// Random nodes, some beyond what a code can be.
std::vector<int16_t> random_node(size_t values, uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<int16_t> node(values);
  for (int16_t& value : node) value = static_cast<int16_t>(static_cast<int>(random() % 2400) - 400);
  return node;
}

TEST(Compose, EqualsThePlainSumOfSamplesSignedLevelsAndMips) {
  const RadianceTable radiance = make_radiance_table();
  const int w = 37, h = 22;
  const size_t texels = static_cast<size_t>(w * h);
  std::vector<std::vector<int16_t>> nodes;
  for (uint32_t n = 0; n < 6; ++n) nodes.push_back(random_node(3 * texels, n));
  const LeafTerm terms[] = {{{nodes[0].data(), nodes[1].data(), nodes[2].data()}, {false, true, false}, 3, 0.25f},
                            {{nodes[3].data()}, {}, 1, 0.75f},
                            {{nodes[4].data(), nodes[5].data()}, {false, true}, 2, 1.0f},
                            {{}, {}, 0, 1.0f}};
  std::vector<float> scratch(compose_scratch_floats(w, h));
  std::vector<uint16_t> out(4 * texels_with_mips(w, h));
  compose_texture(terms, w, h, radiance, scratch, out);
  std::array<std::vector<float>, 3> rgb;
  for (auto& plane : rgb) plane.assign(texels, 0.0f);
  for (const LeafTerm& term : terms)
    for (size_t i = 0; i < texels; ++i) {
      int sum[3] = {0, 0, 0};
      for (int l = 0; l < term.count; ++l)
        for (size_t p = 0; p < 3; ++p)
          sum[p] += (term.subtracted[static_cast<size_t>(l)] ? -1 : 1) * term.planes[static_cast<size_t>(l)][p * texels + i];
      const RgbCode code = rgb_from_ycocg({sum[0], sum[1], sum[2]});
      rgb[0][i] += term.weight * radiance[static_cast<size_t>(std::clamp(code.r, 0, kCodeMax))];
      rgb[1][i] += term.weight * radiance[static_cast<size_t>(std::clamp(code.g, 0, kCodeMax))];
      rgb[2][i] += term.weight * radiance[static_cast<size_t>(std::clamp(code.b, 0, kCodeMax))];
    }
  size_t first = 0;
  for (int lw = w, lh = h;; lw = mip_size(lw), lh = mip_size(lh)) {
    const size_t count = static_cast<size_t>(lw * lh);
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = 0; i < count; ++i) ASSERT_EQ(out[4 * (first + i) + c], half_from_float(rgb[c][i])) << lw << 'x' << lh;
    for (size_t i = 0; i < count; ++i) ASSERT_EQ(out[4 * (first + i) + 3], half_from_float(1));
    if (lw == 1 && lh == 1) break;
    for (auto& plane : rgb) {
      std::vector<float> coarser(static_cast<size_t>(mip_size(lw) * mip_size(lh)));
      decimate(plane.data(), lw, lh, coarser.data());
      plane = coarser;
    }
    first += count;
  }
}

TEST(Compose, WithoutLevelsATextureIsBlack) {
  const RadianceTable radiance = make_radiance_table();
  std::vector<float> scratch(compose_scratch_floats(3, 2), 5.0f);
  std::vector<uint16_t> out(4 * texels_with_mips(3, 2), 77);
  const LeafTerm nothing;
  compose_texture({&nothing, 1}, 3, 2, radiance, scratch, out);
  for (size_t i = 0; i < out.size(); ++i) EXPECT_EQ(out[i], i % 4 == 3 ? 0x3c00 : 0);
}

TEST(Compose, TimeIsPrinted) {
  const RadianceTable radiance = make_radiance_table();
  constexpr int kSize = 256;
  std::vector<std::vector<int16_t>> nodes;
  for (uint32_t n = 0; n < 8; ++n) nodes.push_back(random_node(3 * kSize * kSize, n));
  LeafTerm terms[2];
  for (size_t t = 0; t < 2; ++t) {
    for (size_t l = 0; l < 4; ++l) terms[t].planes[l] = nodes[4 * t + l].data();
    terms[t].count = 4;
  }
  std::vector<float> scratch(compose_scratch_floats(kSize, kSize));
  std::vector<uint16_t> out(4 * texels_with_mips(kSize, kSize));
  double best = 1e9;
  for (int i = 0; i < 20; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    compose_texture(terms, kSize, kSize, radiance, scratch, out);
    best = std::min(best, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  std::printf("256 x 256, two samples of four levels: %.2f ms\n", best);
  RecordProperty("compose_256_two_samples_ms", std::to_string(best));
}

}  // namespace
}  // namespace vitrine
