// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/node_encoder.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <random>

#include "host/encode/context_training.h"
#include "host/encode/field_coder.h"
#include "host/encode/range_encoder.h"
#include "target/decode/node_decoder.h"
#include "tests/encode/synthetic.h"

namespace vitrine {
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

NodeDesc desc_of(const NodeTask& task, const NodeCode& code) {
  NodeDesc desc;
  desc.width = task.width;
  desc.height = task.height;
  std::copy(task.steps.begin(), task.steps.end(), desc.steps);
  desc.contexts = task.contexts;
  desc.units = code.units;
  return desc;
}

std::vector<int16_t> decode(const NodeTask& task, const NodeCode& code, uint64_t budget = ~uint64_t{0}) {
  std::vector<int16_t> planes(task.planes.size(), 12345);
  NodeDecoder decoder;
  EXPECT_TRUE(decoder.start(desc_of(task, code), std::as_bytes(std::span(code.bytes)), planes).ok());
  uint64_t units = 0;
  while (!decoder.done()) {
    const Result<uint64_t> spent = decoder.step(budget);
    EXPECT_TRUE(spent.ok()) << spent.status().detail();
    if (!spent.ok()) break;
    units += spent.value();
  }
  EXPECT_EQ(units, code.units);
  return planes;
}

double squared_error(const CodedPlanes& a, std::span<const int16_t> b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += kPlaneWeights[i / (a.size() / 3)] * (a[i] - b[i]) * (a[i] - b[i]);
  return sum / (static_cast<double>(a.size()) / 3);
}

TEST(NodeEncoder, WhatTheEncoderSeesIsWhatTheTargetShows) {
  NodeEncoder encoder;
  for (const auto& [w, h] : {std::pair{1, 1}, {17, 3}, {3, 17}, {640, 9}, {9, 640}, {32, 32}, {33, 65}, {127, 64}, {256, 256}}) {
    const CodedPlanes planes = synthetic::texture(w, h, {}, {2, 1});
    for (const double step : {1.0, 13.0, 90.0, 700.0}) {
      const NodeTask task = task_of(planes, w, h, step);
      const NodeCode code = encoder.encode(task);
      EXPECT_EQ(decode(task, code), code.planes) << w << " x " << h << " step " << step;
    }
  }
}

TEST(NodeEncoder, AnyBudgetGivesTheSamePicture) {
  const CodedPlanes planes = synthetic::texture(150, 70, {}, {1, 1});
  const NodeTask task = task_of(planes, 150, 70, 30);
  const NodeCode code = NodeEncoder().encode(task);
  for (const uint64_t budget : {uint64_t{1}, uint64_t{500}, uint64_t{7000}, code.units})
    EXPECT_EQ(decode(task, code, budget), code.planes);
}

TEST(NodeEncoder, ExtremeValuesSurvive) {
  std::mt19937 random(2);
  for (const bool clipped : {false, true}) {
    CodedPlanes planes(3 * 40 * 40);
    for (int16_t& v : planes)
      v = static_cast<int16_t>(clipped ? (random() % 2 ? 8190 : -8190) : static_cast<int>(random() % 8191) - 4095);
    const NodeTask task = task_of(planes, 40, 40, 1);
    const NodeCode code = NodeEncoder().encode(task);
    EXPECT_EQ(decode(task, code), code.planes);
  }
}

TEST(NodeEncoder, ADarkNodeTakesNoBytes) {
  const CodedPlanes planes(3 * 100 * 50, 0);
  const NodeTask task = task_of(planes, 100, 50, 10);
  const NodeCode code = NodeEncoder().encode(task);
  EXPECT_TRUE(code.bytes.empty());
  EXPECT_EQ(decode(task, code), planes);
}

TEST(NodeEncoder, FinerStepsLookBetterAndCostMore) {
  const CodedPlanes planes = synthetic::texture(256, 192, {}, {3, 2});
  size_t bytes = 0;
  double error = 1e30;
  for (const double step : {320.0, 160.0, 80.0, 40.0, 20.0, 10.0, 5.0}) {
    const NodeTask task = task_of(planes, 256, 192, step);
    const NodeCode code = NodeEncoder().encode(task);
    EXPECT_GT(code.bytes.size(), bytes);
    EXPECT_LT(squared_error(planes, code.planes), error);
    bytes = code.bytes.size();
    error = squared_error(planes, code.planes);
  }
  EXPECT_LT(error, 2.5);  // a step of 5 codes
}

TEST(NodeEncoder, UnseenTexelsTakeFewBytes) {
  const CodedPlanes planes = synthetic::texture(256, 256, {}, {3, 2});
  NodeTask task = task_of(planes, 256, 256, 20);
  const size_t all = NodeEncoder().encode(task).bytes.size();
  std::vector<float> weights(32 * 32, 1.0f);
  for (size_t i = 512; i < weights.size(); ++i) weights[i] = 0.0005f;
  task.cell_weights = weights;
  EXPECT_LT(NodeEncoder().encode(task).bytes.size(), all * 7 / 10);
}

TEST(NodeEncoder, DamagedNodesNeverDoMoreThanASmallDelay) {
  std::mt19937 random(11);
  const CodedPlanes planes = synthetic::texture(90, 75, {}, {1, 0});
  const NodeTask task = task_of(planes, 90, 75, 12);
  const NodeCode code = NodeEncoder().encode(task);
  for (int trial = 0; trial < 600; ++trial) {
    std::vector<uint8_t> bytes = code.bytes;
    if (trial % 2)
      bytes.resize(random() % bytes.size());
    else
      bytes[random() % bytes.size()] ^= static_cast<uint8_t>(1u << (random() % 8));
    std::vector<int16_t> out(planes.size());
    NodeDecoder decoder;
    NodeDesc desc = desc_of(task, code);
    ASSERT_TRUE(decoder.start(desc, std::as_bytes(std::span(bytes)), out).ok());
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

TEST(RangeCoder, CarriesRunThroughLongRowsOfOnes) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<bool> symbols(static_cast<size_t>(random() % 400));
    for (size_t i = 0; i < symbols.size(); ++i) symbols[i] = random() % 100 < static_cast<unsigned>(trial % 3 * 49 + 1);
    std::vector<uint8_t> bytes;
    AdaptiveBit write, read;
    RangeEncoder encoder(bytes);
    for (size_t i = 0; i < symbols.size(); ++i) {
      if (i % 5 == 4)
        encoder.raw(symbols[i]);
      else
        encoder.bit(write, symbols[i]);
    }
    encoder.finish();
    RangeDecoder decoder;
    decoder.start(std::as_bytes(std::span(bytes)));
    for (size_t i = 0; i < symbols.size(); ++i)
      ASSERT_EQ(i % 5 == 4 ? decoder.raw() : decoder.bit(read), symbols[i]) << trial << " at " << i;
  }
}

TEST(ContextTraining, TrainedStatesMakeSmallNodesSmaller) {
  NodeEncoder encoder;
  std::vector<CodedSymbols> symbols(6);
  size_t before = 0, after = 0;
  std::vector<CodedPlanes> textures;
  for (int i = 0; i < 6; ++i) textures.push_back(synthetic::texture(96, 64, {}, {i, 0}));
  for (size_t i = 0; i < 6; ++i) before += encoder.encode(task_of(textures[i], 96, 64, 60), &symbols[i]).bytes.size();
  std::vector<const CodedSymbols*> nodes;
  for (const CodedSymbols& s : symbols) nodes.push_back(&s);
  const std::vector<uint8_t> contexts = train_contexts(nodes, default_context_bytes(), 1);
  ASSERT_EQ(contexts.size(), static_cast<size_t>(kContextBytesPerLevel));
  for (size_t i = 0; i < 6; ++i) {
    NodeTask task = task_of(textures[i], 96, 64, 60);
    task.contexts = contexts;
    const NodeCode code = encoder.encode(task);
    EXPECT_EQ(decode(task, code), code.planes);
    after += code.bytes.size();
  }
  EXPECT_LT(after, before * 97 / 100);
}

// Not a test of speed (machines differ and are shared): prints what the plan's units mean here.
TEST(NodeDecoder, PrintsItsSpeed) {
  const CodedPlanes planes = synthetic::texture(512, 512, {}, {3, 2});
  for (const double step : {25.0, 60.0, 200.0}) {
    const NodeTask task = task_of(planes, 512, 512, step);
    const NodeCode code = NodeEncoder().encode(task);
    std::vector<int16_t> out(planes.size());
    double best = 1e9;
    for (int r = 0; r < 5; ++r) {
      timespec from, to;
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &from);
      NodeDecoder decoder;
      ASSERT_TRUE(decoder.start(desc_of(task, code), std::as_bytes(std::span(code.bytes)), out).ok());
      while (!decoder.done()) ASSERT_TRUE(decoder.step(100000).ok());
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &to);
      best = std::min(best, static_cast<double>(to.tv_sec - from.tv_sec) + 1e-9 * static_cast<double>(to.tv_nsec - from.tv_nsec));
    }
    std::printf("%.3f bit/texel: %.0f Mtexel/s on one core, %.2f ns per unit\n",
                8.0 * static_cast<double>(code.bytes.size()) / (512 * 512), 512 * 512 / best / 1e6,
                1e9 * best / static_cast<double>(code.units));
  }
}

}  // namespace
}  // namespace vitrine
