// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/decode/node_decoder.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace vitrine {
namespace {

NodeDesc desc_of(int width, int height) {
  NodeDesc desc;
  desc.width = width;
  desc.height = height;
  for (uint16_t& s : desc.steps) s = 160;
  return desc;
}

TEST(NodeDecoder, NoBytesAreTheAllZeroNode) {
  for (const auto& [w, h] : {std::pair{1, 1}, {33, 31}, {640, 9}}) {
    std::vector<int16_t> planes(static_cast<size_t>(3 * w * h), 77);
    NodeDecoder decoder;
    ASSERT_TRUE(decoder.start(desc_of(w, h), {}, planes).ok());
    uint64_t units = 0;
    while (!decoder.done()) units += decoder.step(1).value();
    EXPECT_EQ(units, kUnitsPerNode + kUnitsPerTile * static_cast<uint64_t>((w + 31) / 32 * ((h + 31) / 32)));
    EXPECT_EQ(planes, std::vector<int16_t>(planes.size(), 0));
  }
}

TEST(NodeDecoder, RefusesDescriptionsOutOfRange) {
  std::vector<int16_t> planes(3 * 16 * 16);
  NodeDecoder decoder;
  for (const auto& [w, h] : {std::pair{0, 4}, {4, -1}, {kMaxNodeSize + 1, 1}, {1, kMaxNodeSize + 1}}) {
    EXPECT_EQ(decoder.start(desc_of(w, h), {}, planes).code(), StatusCode::kMalformed);
    EXPECT_TRUE(decoder.done());
  }
  EXPECT_EQ(decoder.start(desc_of(17, 16), {}, planes).code(), StatusCode::kOutOfMemory);
  NodeDesc no_step = desc_of(16, 16);
  no_step.steps[1] = 0;
  EXPECT_EQ(decoder.start(no_step, {}, planes).code(), StatusCode::kMalformed);
  NodeDesc few_contexts = desc_of(16, 16);
  const std::vector<uint8_t> contexts(kContextBytesPerLevel - 1, 128);
  few_contexts.contexts = contexts;
  EXPECT_EQ(decoder.start(few_contexts, {}, planes).code(), StatusCode::kMalformed);
  EXPECT_TRUE(decoder.start(desc_of(16, 16), {}, planes).ok());
}

// Every coefficient of every plane takes at most about 40 symbols, so no tile can take more units than this.
constexpr uint64_t kWorstTile = 3 * 1024 * 45 * (kUnitsPerSymbol + 2 * kUnitsPerByte) + 100000;

TEST(NodeDecoder, AnyBytesDecodeInBoundedTimeToValuesInRange) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 400; ++trial) {
    const int w = 1 + static_cast<int>(random() % 90), h = 1 + static_cast<int>(random() % 90);
    std::vector<std::byte> bytes(1 + random() % 600);
    for (std::byte& b : bytes) b = static_cast<std::byte>(trial % 4 == 0 ? 0xff : trial % 4 == 1 ? random() % 3 : random());
    std::vector<uint8_t> contexts(kContextBytesPerLevel);
    for (uint8_t& c : contexts) c = static_cast<uint8_t>(random());
    std::vector<int16_t> planes(static_cast<size_t>(3 * w * h));  // exactly sized: an overrun is found by the sanitizer
    NodeDesc desc = desc_of(w, h);
    for (uint16_t& s : desc.steps) s = static_cast<uint16_t>(1 + random() % 65535);
    if (trial % 2) desc.contexts = contexts;
    NodeDecoder decoder;
    ASSERT_TRUE(decoder.start(desc, bytes, planes).ok());
    int steps = 0;
    while (!decoder.done()) {
      const Result<uint64_t> spent = decoder.step(1);
      ASSERT_TRUE(spent.ok());
      EXPECT_GE(spent.value(), 1u);
      EXPECT_LE(spent.value(), kWorstTile);
      ASSERT_LE(++steps, 9);
    }
    for (const int16_t v : planes) ASSERT_LE(std::abs(static_cast<int>(v)), kNodeValueMax);
  }
}

TEST(NodeDecoder, MoreWorkThanDeclaredStopsAndLeavesNothing) {
  std::mt19937 random(3);
  std::vector<std::byte> bytes(4000);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  std::vector<int16_t> planes(3 * 256 * 256);
  NodeDesc desc = desc_of(256, 256);
  NodeDecoder honest;
  ASSERT_TRUE(honest.start(desc, bytes, planes).ok());
  const uint64_t units = honest.step(~uint64_t{0}).value();
  for (const uint64_t declared : {uint64_t{1}, units / 2, units - 1, units + 1}) {
    desc.units = declared;
    NodeDecoder decoder;
    ASSERT_TRUE(decoder.start(desc, bytes, planes).ok());
    planes.assign(planes.size(), 77);
    EXPECT_EQ(decoder.step(~uint64_t{0}).status().code(), StatusCode::kMalformed);
    EXPECT_TRUE(decoder.done());
    EXPECT_EQ(planes, std::vector<int16_t>(planes.size(), 0));
  }
  desc.units = units;
  NodeDecoder decoder;
  ASSERT_TRUE(decoder.start(desc, bytes, planes).ok());
  EXPECT_TRUE(decoder.step(~uint64_t{0}).ok());
}

TEST(NodeDecoder, MayBeCopiedBetweenSteps) {
  std::mt19937 random(5);
  std::vector<std::byte> bytes(900);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  std::vector<int16_t> once(3 * 100 * 70), moved(once.size());
  NodeDecoder a, b;
  ASSERT_TRUE(a.start(desc_of(100, 70), bytes, once).ok());
  while (!a.done()) ASSERT_TRUE(a.step(1000000).ok());
  ASSERT_TRUE(a.start(desc_of(100, 70), bytes, moved).ok());
  for (int i = 0; !a.done(); ++i) {
    ASSERT_TRUE(a.step(1).ok());
    b = a;
    a = b;
  }
  EXPECT_EQ(once, moved);
}

}  // namespace
}  // namespace vitrine
