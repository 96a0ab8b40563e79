// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/decode/spiht_decoder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "formats/wavelet.h"
#include "target/decode/wavelet_kernels.h"

namespace vitrine::spiht {
namespace {

NodeDesc desc_of(int width, int height) {
  NodeDesc desc;
  desc.width = width;
  desc.height = height;
  for (uint16_t& s : desc.steps) s = 160;
  return desc;
}

std::vector<std::byte> random_bytes(std::mt19937& random, size_t count) {
  std::vector<std::byte> bytes(count);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  return bytes;
}

struct Decoded {
  std::vector<int16_t> planes;
  uint64_t units = 0;
};
// Memory is exactly as large as it must be: the sanitizers find whatever goes beyond.
Decoded decode(const NodeDesc& desc, std::span<const std::byte> bytes, uint64_t units_a_step) {
  Decoded out;
  out.planes.assign(3 * static_cast<size_t>(desc.width) * static_cast<size_t>(desc.height), 77);
  std::vector<uint16_t> scratch(spiht_scratch_words(desc.width, desc.height), 0xabcd);
  SpihtDecoder decoder;
  EXPECT_TRUE(decoder.start(desc, bytes, out.planes, scratch).ok());
  while (!decoder.done()) {
    const Result<uint64_t> spent = decoder.step(units_a_step);
    EXPECT_TRUE(spent.ok());
    if (!spent.ok()) break;
    EXPECT_GE(spent.value(), 1u);
    out.units += spent.value();
  }
  return out;
}

TEST(SpihtDecoder, NoBytesAreTheAllZeroNode) {
  for (const auto& [w, h] : {std::pair{1, 1}, {33, 31}, {640, 9}}) {
    const Decoded out = decode(desc_of(w, h), {}, 1);
    EXPECT_EQ(out.planes, std::vector<int16_t>(out.planes.size(), 0));
    EXPECT_EQ(out.units, static_cast<uint64_t>(h) * spiht_units_of_clearing(w));
  }
}

TEST(SpihtDecoder, RefusesDescriptionsOutOfRange) {
  std::vector<int16_t> planes(3 * 16 * 16);
  std::vector<uint16_t> scratch(spiht_scratch_words(16, 16));
  SpihtDecoder decoder;
  for (const auto& [w, h] : {std::pair{0, 4}, {4, -1}, {kMaxNodeSize + 1, 1}, {1, kMaxNodeSize + 1}}) {
    EXPECT_EQ(decoder.start(desc_of(w, h), {}, planes, scratch).code(), StatusCode::kMalformed);
    EXPECT_TRUE(decoder.done());
  }
  EXPECT_EQ(decoder.start(desc_of(17, 16), {}, planes, scratch).code(), StatusCode::kOutOfMemory);
  EXPECT_EQ(decoder.start(desc_of(16, 16), {}, planes, std::span(scratch).first(scratch.size() - 1)).code(),
            StatusCode::kOutOfMemory);
  NodeDesc no_step = desc_of(16, 16);
  no_step.steps[1] = 0;
  EXPECT_EQ(decoder.start(no_step, {}, planes, scratch).code(), StatusCode::kMalformed);
  NodeDesc few_contexts = desc_of(16, 16);
  const std::vector<uint8_t> contexts(kSpihtContextCount - 1, 128);
  few_contexts.contexts = contexts;
  EXPECT_EQ(decoder.start(few_contexts, {}, planes, scratch).code(), StatusCode::kMalformed);
  EXPECT_TRUE(decoder.start(desc_of(16, 16), {}, planes, scratch).ok());
}

TEST(SpihtDecoder, MemoryIsBoundedByTheSizeOfTheNode) {
  for (const auto& [w, h] : {std::pair{256, 256}, {640, 480}, {1000, 333}, {8192, 64}})
    EXPECT_LE(static_cast<double>(spiht_scratch_words(w, h)), 2.2 * w * h) << w << " x " << h;
  EXPECT_LE(sizeof(SpihtDecoder), size_t{4096});
}

TEST(SpihtDecoder, AnyBytesDecodeInBoundedTimeToValuesInRange) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 400; ++trial) {
    const int w = 1 + static_cast<int>(random() % 90), h = 1 + static_cast<int>(random() % 90);
    std::vector<std::byte> bytes = random_bytes(random, 1 + random() % 600);
    if (trial % 4 < 2)
      for (std::byte& b : bytes) b = trial % 4 == 0 ? std::byte{0xff} : b & std::byte{3};
    std::vector<uint8_t> contexts(kSpihtContextCount);
    for (uint8_t& c : contexts) c = static_cast<uint8_t>(random());
    NodeDesc desc = desc_of(w, h);
    for (uint16_t& s : desc.steps) s = static_cast<uint16_t>(1 + random() % 65535);
    if (trial % 2) desc.contexts = contexts;
    const Decoded out = decode(desc, bytes, 1);
    for (const int16_t v : out.planes) ASSERT_LE(std::abs(static_cast<int>(v)), kNodeValueMax);
    // At most a few symbols for each bit of each coefficient, whatever the bytes are.
    EXPECT_LE(out.units, static_cast<uint64_t>(w * h) * 3 * 15 * 4 * kSpihtUnitsPerSymbol + 100000);
  }
}

TEST(SpihtDecoder, AnyBudgetGivesTheSamePicture) {
  std::mt19937 random(9);
  for (const auto& [w, h] : {std::pair{100, 70}, {5, 61}}) {
    const std::vector<std::byte> bytes = random_bytes(random, 900);
    const Decoded once = decode(desc_of(w, h), bytes, ~uint64_t{0});
    for (const uint64_t units : {1, 100, 5000}) {
      const Decoded stepped = decode(desc_of(w, h), bytes, units);
      EXPECT_EQ(stepped.planes, once.planes);
      EXPECT_EQ(stepped.units, once.units);
    }
  }
}

TEST(SpihtDecoder, OtherWorkThanDeclaredIsAnError) {
  std::mt19937 random(3);
  const std::vector<std::byte> bytes = random_bytes(random, 4000);
  NodeDesc desc = desc_of(256, 256);
  const uint64_t units = decode(desc, bytes, ~uint64_t{0}).units;
  std::vector<int16_t> planes(3 * 256 * 256);
  std::vector<uint16_t> scratch(spiht_scratch_words(256, 256));
  for (const uint64_t declared : {uint64_t{1}, units / 2, units - 1, units + 1}) {
    desc.units = declared;
    SpihtDecoder decoder;
    ASSERT_TRUE(decoder.start(desc, bytes, planes, scratch).ok());
    EXPECT_EQ(decoder.step(~uint64_t{0}).status().code(), StatusCode::kMalformed);
    EXPECT_TRUE(decoder.done());
  }
  desc.units = units;
  SpihtDecoder decoder;
  ASSERT_TRUE(decoder.start(desc, bytes, planes, scratch).ok());
  EXPECT_TRUE(decoder.step(~uint64_t{0}).ok());
}

TEST(SpihtDecoder, MayBeCopiedBetweenSteps) {
  std::mt19937 random(5);
  const std::vector<std::byte> bytes = random_bytes(random, 900);
  const Decoded once = decode(desc_of(100, 70), bytes, ~uint64_t{0});
  std::vector<int16_t> moved(once.planes.size());
  std::vector<uint16_t> scratch(spiht_scratch_words(100, 70));
  SpihtDecoder a, b;
  ASSERT_TRUE(a.start(desc_of(100, 70), bytes, moved, scratch).ok());
  while (!a.done()) {
    ASSERT_TRUE(a.step(1).ok());
    b = a;
    a = b;
  }
  EXPECT_EQ(once.planes, moved);
}

// A checksum that every machine and every kind of vectors must reproduce.
TEST(SpihtDecoder, EveryMachineDecodesTheSameTexels) {
  uint64_t hash = 0xcbf29ce484222325u;
  uint32_t state = 1;
  for (const auto& [w, h] : {std::pair{1, 1}, {7, 130}, {64, 64}, {201, 77}}) {
    std::vector<std::byte> bytes(static_cast<size_t>(20 + w * h / 10));
    for (std::byte& b : bytes) b = static_cast<std::byte>((state = state * 1664525u + 1013904223u) >> 24);
    for (const int16_t v : decode(desc_of(w, h), bytes, 1000).planes) hash = (hash ^ static_cast<uint16_t>(v)) * 0x100000001b3u;
  }
  EXPECT_EQ(hash, 13023892670189472598u);
}

TEST(WaveletKernels, VectorsDoWhatTheFormulasSay) {
  std::mt19937 random(2);
  for (int n = 1; n < 90; ++n) {
    std::vector<int16_t> in(5 * static_cast<size_t>(n)), out(static_cast<size_t>(n));
    for (int16_t& v : in) v = static_cast<int16_t>(random());  // wraps are part of the definition
    const int16_t *x = in.data(), *a = x + n, *b = a + n, *c = b + n, *d = c + n;
    invert_update_row(x, {a, b, c, d}, n, out.data());
    for (int i = 0; i < n; ++i)
      ASSERT_EQ(out[static_cast<size_t>(i)], static_cast<int16_t>(x[i] - wavelet_update(a[i], b[i], c[i], d[i])));
    invert_predict_row(x, {a, b, c, d}, n, out.data());
    for (int i = 0; i < n; ++i)
      ASSERT_EQ(out[static_cast<size_t>(i)], static_cast<int16_t>(x[i] + wavelet_predict(a[i], b[i], c[i], d[i])));
  }
}

}  // namespace
}  // namespace vitrine::spiht
