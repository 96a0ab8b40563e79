// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/spiht_encoder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "formats/wavelet.h"
#include "host/encode/context_training.h"
#include "host/encode/field_coder.h"
#include "host/encode/forward_wavelet.h"
#include "target/decode/node_decoder.h"
#include "target/decode/spiht_decoder.h"
#include "target/decode/wavelet_kernels.h"
#include "tests/encode/synthetic.h"

namespace vitrine::spiht {
namespace {

NodeTask task_of(const CodedPlanes& planes, int width, int height, double step) {
  NodeTask task;
  task.width = width;
  task.height = height;
  task.planes = planes;
  for (size_t p = 0; p < kNodePlanes; ++p) {
    task.steps[p] = static_cast<uint16_t>(std::max(1.0, std::round(8 * step / std::sqrt(static_cast<double>(kPlaneWeights[p])))));
    task.weights[p] = kPlaneWeights[p] / static_cast<float>(kPricePerStep2 * step * step);
  }
  return task;
}

NodeDesc desc_of(const NodeTask& task, uint64_t units) {
  NodeDesc desc;
  desc.width = task.width;
  desc.height = task.height;
  std::copy(task.steps.begin(), task.steps.end(), desc.steps);
  desc.contexts = task.contexts;
  desc.units = units;
  return desc;
}

std::vector<int16_t> decode(const NodeTask& task, std::span<const uint8_t> bytes, uint64_t units) {
  std::vector<int16_t> planes(task.planes.size(), 12345);
  std::vector<uint16_t> scratch(spiht_scratch_words(task.width, task.height), 0x5555);
  SpihtDecoder decoder;
  EXPECT_TRUE(decoder.start(desc_of(task, units), std::as_bytes(bytes), planes, scratch).ok());
  while (!decoder.done()) {
    const Result<uint64_t> spent = decoder.step(3000);
    EXPECT_TRUE(spent.ok()) << spent.status().detail();
    if (!spent.ok()) break;
  }
  return planes;
}

double squared_error(const CodedPlanes& a, std::span<const int16_t> b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i)
    sum += static_cast<double>(kPlaneWeights[i / (a.size() / 3)] * static_cast<float>((a[i] - b[i]) * (a[i] - b[i])));
  return sum / (static_cast<double>(a.size()) / 3);
}

double psnr(const CodedPlanes& a, std::span<const int16_t> b) { return 10 * std::log10(1023.0 * 1023.0 / squared_error(a, b)); }

// As SpihtDecoder, without quantization.
std::vector<int16_t> inverse_wavelet(const SpihtLayout& layout, std::vector<int16_t> samples) {
  const size_t stride = static_cast<size_t>(layout.width[0]);
  for (int k = layout.levels; k > 0; --k) {
    const int width = layout.width[static_cast<size_t>(k) - 1], height = layout.height[static_cast<size_t>(k) - 1];
    std::vector<int16_t> lines(samples.size());
    const auto row = [&](std::vector<int16_t>& of, int y) { return &of[static_cast<size_t>(y) * stride]; };
    const auto high = [&](int y) { return row(samples, band_place(mirrored(y, height), height)); };
    const auto even = [&](int y) { return row(lines, mirrored(y, height)); };
    for (int y = 0; y < height; y += 2) {
      if (height == 1)
        std::copy_n(row(samples, 0), width, row(lines, 0));
      else
        invert_update_row(row(samples, y / 2), {high(y - 1), high(y + 1), high(y - 3), high(y + 3)}, width, row(lines, y));
    }
    for (int y = 1; y < height; y += 2)
      invert_predict_row(high(y), {even(y - 1), even(y + 1), even(y - 3), even(y + 3)}, width, row(lines, y));
    for (int y = 0; y < height; ++y) invert_line(row(lines, y), width, true, row(samples, y));
  }
  return samples;
}

TEST(Wavelet, ReconstructsEveryTexelOfEverySize) {
  std::mt19937 random(1);
  for (int h = 1; h <= 67; h += 1 + h / 12)
    for (int w = 1; w <= 67; w += 1 + w / 12) {
      std::vector<int16_t> texels(static_cast<size_t>(w * h));
      for (int16_t& t : texels) t = static_cast<int16_t>(static_cast<int>(random() % (2 * kNodeValueMax + 1)) - kNodeValueMax);
      const SpihtLayout layout = spiht_layout(w, h);
      std::vector<int16_t> back = inverse_wavelet(layout, forward_wavelet(layout, texels));
      texels_from_samples(back.data(), w * h);
      ASSERT_EQ(back, texels) << w << " x " << h;
    }
}

TEST(SpihtEncoder, WhatTheEncoderSeesIsWhatTheTargetShowsAtEverySize) {
  SpihtEncoder encoder;
  for (int h = 1; h <= 67; h += 3)
    for (int w = 1; w <= 65; w += 4) {
      const CodedPlanes planes = synthetic::texture(w, h, {}, {2, 1});
      const NodeTask task = task_of(planes, w, h, 8);
      const NodeCode code = encoder.encode(task);
      ASSERT_EQ(decode(task, code.bytes, code.units), code.planes) << w << " x " << h;
      EXPECT_GT(psnr(planes, code.planes), 38) << w << " x " << h;
    }
}

TEST(SpihtEncoder, FinestStepsLoseNextToNothing) {
  const CodedPlanes planes = synthetic::texture(90, 67, {}, {3, 2});
  const NodeTask task = task_of(planes, 90, 67, 0.5);
  EXPECT_LT(squared_error(planes, SpihtEncoder().encode(task).planes), 1.5);
}

TEST(SpihtEncoder, ExtremeValuesSurvive) {
  std::mt19937 random(2);
  for (const bool clipped : {false, true}) {
    CodedPlanes planes(3 * 40 * 40);
    for (int16_t& v : planes)
      v = static_cast<int16_t>(clipped ? (random() % 2 ? 8190 : -8190) : static_cast<int>(random() % 8191) - 4095);
    const NodeTask task = task_of(planes, 40, 40, 1);
    const NodeCode code = SpihtEncoder().encode(task);
    EXPECT_EQ(decode(task, code.bytes, code.units), code.planes);
  }
}

TEST(SpihtEncoder, ADarkNodeTakesNoBytes) {
  const CodedPlanes planes(3 * 100 * 50, 0);
  const NodeTask task = task_of(planes, 100, 50, 10);
  const NodeCode code = SpihtEncoder().encode(task);
  EXPECT_TRUE(code.bytes.empty());
  EXPECT_EQ(decode(task, code.bytes, code.units), planes);
}

TEST(SpihtEncoder, FinerStepsLookBetterAndCostMore) {
  const CodedPlanes planes = synthetic::texture(256, 192, {}, {3, 2});
  size_t bytes = 0;
  double error = 1e30;
  for (const double step : {320.0, 160.0, 80.0, 40.0, 20.0, 10.0, 5.0}) {
    const NodeCode code = SpihtEncoder().encode(task_of(planes, 256, 192, step));
    EXPECT_GT(code.bytes.size(), bytes);
    EXPECT_LT(squared_error(planes, code.planes), error);
    bytes = code.bytes.size();
    error = squared_error(planes, code.planes);
  }
  EXPECT_LT(error, 3);  // a step of 5 codes, and what is not worth its bits
}

TEST(SpihtEncoder, ANodeMayBeCutOffAtAnyByte) {
  const CodedPlanes planes = synthetic::texture(120, 77, {}, {3, 2});
  const NodeTask task = task_of(planes, 120, 77, 40);
  const NodeCode code = SpihtEncoder().encode(task);
  const std::span bytes(code.bytes);
  double best = 0;
  for (size_t length = 0; length <= bytes.size(); ++length) {
    const double now = psnr(planes, decode(task, bytes.first(length), 0));
    EXPECT_GT(now, best - 0.3) << length << " of " << bytes.size();  // single bytes may look a little worse
    best = std::max(best, now);
  }
  double before = 0;
  for (const size_t quarters : {1, 2, 3, 4}) {
    const double now = psnr(planes, decode(task, bytes.first(bytes.size() * quarters / 4), 0));
    EXPECT_GT(now, before + 1);
    before = now;
  }
}

TEST(SpihtEncoder, KeepsToABudgetOfBytes) {
  const CodedPlanes planes = synthetic::texture(120, 77, {}, {3, 2});
  const NodeTask task = task_of(planes, 120, 77, 20);
  for (const size_t budget : {0, 1, 50, 300}) {
    const NodeCode code = SpihtEncoder().encode(task, nullptr, budget);
    EXPECT_EQ(code.bytes.size(), budget);
    EXPECT_EQ(decode(task, code.bytes, code.units), code.planes);
  }
}

TEST(SpihtEncoder, UnseenTexelsTakeFewBytes) {
  const CodedPlanes planes = synthetic::texture(256, 256, {}, {3, 2});
  NodeTask task = task_of(planes, 256, 256, 20);
  const size_t all = SpihtEncoder().encode(task).bytes.size();
  std::vector<float> weights(32 * 32, 1.0f);
  for (size_t i = 512; i < weights.size(); ++i) weights[i] = 0.0005f;
  task.cell_weights = weights;
  EXPECT_LT(SpihtEncoder().encode(task).bytes.size(), all * 7 / 10);
}

TEST(SpihtEncoder, TrainedStatesMakeSmallNodesSmaller) {
  SpihtEncoder encoder;
  const std::vector<uint8_t> even(kSpihtContextCount, 32 << 2 | 1);
  std::vector<CodedSymbols> symbols(6);
  double before = 0, after = 0;
  std::vector<CodedPlanes> textures;
  const auto cost = [](const NodeTask& task, const CodedPlanes& planes, const NodeCode& code) {
    return 8.0 * static_cast<double>(code.bytes.size()) +
           squared_error(planes, code.planes) * static_cast<double>(task.weights[0]) * 96 * 64;
  };
  for (int i = 0; i < 6; ++i) textures.push_back(synthetic::texture(96, 64, {}, {i, 0}));
  for (size_t i = 0; i < 6; ++i) {
    NodeTask task = task_of(textures[i], 96, 64, 60);
    task.contexts = even;
    before += cost(task, textures[i], encoder.encode(task, &symbols[i]));
  }
  std::vector<const CodedSymbols*> nodes;
  for (const CodedSymbols& s : symbols) nodes.push_back(&s);
  const std::vector<uint8_t> contexts = train_contexts(nodes, even, 1);
  ASSERT_EQ(contexts.size(), static_cast<size_t>(kSpihtContextCount));
  for (size_t i = 0; i < 6; ++i) {
    NodeTask task = task_of(textures[i], 96, 64, 60);
    task.contexts = contexts;
    const NodeCode code = encoder.encode(task);
    EXPECT_EQ(decode(task, code.bytes, code.units), code.planes);
    after += cost(task, textures[i], code);
  }
  EXPECT_LT(after, before * 0.97);
}

TEST(SpihtEncoder, DamagedNodesNeverDoMoreThanDeclared) {
  std::mt19937 random(11);
  const CodedPlanes planes = synthetic::texture(90, 75, {}, {1, 0});
  const NodeTask task = task_of(planes, 90, 75, 12);
  const NodeCode code = SpihtEncoder().encode(task);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<uint8_t> bytes = code.bytes;
    if (trial % 2)
      bytes.resize(random() % bytes.size());
    else
      bytes[random() % bytes.size()] ^= static_cast<uint8_t>(1u << (random() % 8));
    std::vector<int16_t> out(planes.size());
    std::vector<uint16_t> scratch(spiht_scratch_words(90, 75));
    SpihtDecoder decoder;
    ASSERT_TRUE(decoder.start(desc_of(task, code.units), std::as_bytes(std::span(bytes)), out, scratch).ok());
    uint64_t spent = 0;
    while (!decoder.done()) {
      const Result<uint64_t> step = decoder.step(4096);
      if (!step.ok()) break;
      spent += step.value();
    }
    EXPECT_TRUE(decoder.done());
    EXPECT_LE(spent, code.units);
  }
}

}  // namespace
}  // namespace vitrine::spiht
