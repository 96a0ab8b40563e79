// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numeric>

#include "formats/node_coding.h"
#include "host/base/error.h"
#include "host/base/progress.h"
#include "host/encode/encode.h"
#include "host/encode/price_search.h"
#include "target/decode/node_decoder.h"
#include "tests/encode/synthetic.h"

namespace vitrine {
namespace {

std::vector<EncodedField> encode(const std::vector<FieldSource>& fields, const EncodeOptions& options) {
  return encode_fields(fields, options, silent_progress());
}

std::vector<size_t> node_offsets(const EncodedField& field) {
  std::vector<size_t> offsets{0};
  for (const uint32_t bytes : field.node_bytes) offsets.push_back(offsets.back() + bytes);
  return offsets;
}

CodedPlanes decode_node(const FieldSource& source, const EncodedField& field, const std::vector<size_t>& offsets, int node) {
  const size_t level = static_cast<size_t>(field.shape.level_of(node)), n = static_cast<size_t>(node);
  CodedPlanes planes(3 * static_cast<size_t>(source.width * source.height));
  NodeDesc desc;
  desc.width = source.width;
  desc.height = source.height;
  for (size_t p = 0; p < 3; ++p) desc.steps[p] = field.level_steps[3 * level + p];
  desc.contexts = std::span(field.contexts).subspan(level * kContextBytesPerLevel, kContextBytesPerLevel);
  desc.units = field.node_units[n];
  NodeDecoder decoder;
  EXPECT_TRUE(decoder.start(desc, std::as_bytes(std::span(field.nodes).subspan(offsets[n], field.node_bytes[n])), planes).ok());
  while (!decoder.done()) EXPECT_TRUE(decoder.step(1 << 20).ok());
  return planes;
}

// The leaf of a sample, as the target sums it.
CodedPlanes leaf_of(const FieldSource& source, const EncodedField& field, const std::vector<size_t>& offsets, int64_t flat) {
  CodedPlanes sum(3 * static_cast<size_t>(source.width * source.height), 0);
  for (int level = 0; level < field.shape.pyramid.level_count; ++level) {
    const GridIndex sample = source.space.index_from_flat(flat);
    const CodedPlanes node = decode_node(source, field, offsets, field.shape.node_of(sample, level));
    const int sign = field.shape.subtracts(sample, level) ? -1 : 1;
    for (size_t i = 0; i < sum.size(); ++i) sum[i] = static_cast<int16_t>(sum[i] + sign * node[i]);
  }
  return sum;
}

// Mean over R, G, B as EncodedField::squared_error has it (differences in Y, Co, Cg, so without the rounding of the lifting).
double leaf_error(const FieldSource& source, const CodedPlanes& leaf, const CodedPlanes& truth) {
  const size_t n = leaf.size() / 3;
  double total = 0;
  for (size_t i = 0; i < n; ++i) {
    const double y = truth[i] - leaf[i], co = truth[n + i] - leaf[n + i], cg = truth[2 * n + i] - leaf[2 * n + i];
    const double g = y + cg / 2, r = y - cg / 2 + co / 2, b = y - cg / 2 - co / 2;
    total += static_cast<double>(source.importance[0][i]) * (r * r + g * g + b * b) / 3;
  }
  return total;
}

void expect_consistent(const FieldSource& source, const EncodedField& field) {
  ASSERT_TRUE(field.shape.valid());
  ASSERT_EQ(field.node_bytes.size(), static_cast<size_t>(field.shape.node_count()));
  ASSERT_EQ(field.node_units.size(), field.node_bytes.size());
  ASSERT_EQ(field.level_steps.size(), static_cast<size_t>(3 * field.shape.pyramid.level_count));
  ASSERT_EQ(field.contexts.size(), static_cast<size_t>(kContextBytesPerLevel * field.shape.pyramid.level_count));
  const auto offsets = node_offsets(field);
  ASSERT_EQ(offsets.back(), field.nodes.size());
  double error = 0;
  for (int64_t s = 0; s < source.space.sample_count(); ++s)
    error += leaf_error(source, leaf_of(source, field, offsets, s), source.load(s));
  EXPECT_NEAR(error, field.squared_error, 1e-4 * field.squared_error + 1);
}

TEST(EncodeFields, LeavesSummedByTheTargetHaveTheDeclaredError) {
  FieldSource staggered = synthetic::field({11, 5}, 70, 45);
  staggered.stagger = {3, 1};
  for (const FieldSource& source : {synthetic::field({}, 40, 33), synthetic::field({1}, 64, 64), synthetic::field({3}, 20, 50),
                                    synthetic::field({4, 3, 2}, 33, 40), staggered}) {
    const auto encoded = encode({source}, {.quantizer = 120});
    ASSERT_EQ(encoded.size(), 1u);
    expect_consistent(source, encoded[0]);
  }
}

TEST(EncodeFields, StorageIsMetFromBelowWithinOnePercent) {
  const std::vector<FieldSource> fields = {synthetic::field({8, 4}, 72, 64),
                                           synthetic::field({8}, 64, 96, {.grain = 0.4f, .seed = 3}),
                                           synthetic::field({}, 128, 128, {.seed = 4})};
  for (const uint64_t target : {uint64_t{12000}, uint64_t{40000}}) {
    const auto encoded = encode(fields, {.target_bytes = target});
    uint64_t bytes = 0;
    for (const EncodedField& f : encoded) bytes += f.bytes();
    EXPECT_LE(bytes, target);
    EXPECT_GE(bytes, target * 99 / 100);
  }
}

TEST(EncodeFields, StorageBeyondWhatADisplayShowsIsNotUsed) {
  const std::vector<FieldSource> fields = {synthetic::field({8, 4}, 72, 64)};
  uint64_t bytes[2];
  for (const int i : {0, 1}) {
    bytes[i] = 0;
    for (const EncodedField& f : encode(fields, {.target_bytes = i ? uint64_t{64000000} : uint64_t{4000000}}))
      bytes[i] += f.bytes();
  }
  EXPECT_EQ(bytes[0], bytes[1]);
  EXPECT_LT(bytes[0], 4000000u / 4);
}

TEST(EncodeFields, MoreStorageLooksBetter) {
  const FieldSource source = synthetic::field({8, 4}, 64, 64);
  double error = 1e30;
  for (const uint64_t target : {4000, 8000, 16000, 32000}) {
    const double now = encode({source}, {.target_bytes = target})[0].squared_error;
    EXPECT_LT(now, 0.8 * error);
    error = now;
  }
}

TEST(EncodeFields, EveryWiderChoiceOfPyramidsLooksBetter) {
  synthetic::Look look;
  look.speed = {3, 1.5f};
  const FieldSource source = synthetic::field({8, 8}, 64, 64, look);
  double error = 1e30;
  for (const PyramidKind kind : {PyramidKind::kIsotropic, PyramidKind::kResiduals, PyramidKind::kBest}) {
    const double now = encode({source}, {.pyramid = kind, .target_bytes = 12000})[0].squared_error;
    EXPECT_LT(now, 0.95 * error) << static_cast<int>(kind);
    error = now;
  }
}

TEST(EncodeFields, AnAxisOnWhichNothingMovesIsNotSubdividedEarly) {
  synthetic::Look look;
  look.speed = {10, 0};
  const auto encoded = encode({synthetic::field({8, 8}, 64, 64, look)}, {.target_bytes = 12000});
  // All detail is shared along the quiet axis: some level has cells of one sample along the first and all along the second.
  const FieldShape& shape = encoded[0].shape;
  uint64_t shared = 0, all = 0;
  for (int node = 0; node < shape.node_count(); ++node) {
    all += encoded[0].node_bytes[static_cast<size_t>(node)];
    if (shape.pyramid.cell[static_cast<size_t>(shape.level_of(node))][1] == 8)
      shared += encoded[0].node_bytes[static_cast<size_t>(node)];
  }
  EXPECT_GT(static_cast<double>(shared), 0.95 * static_cast<double>(all));
}

TEST(EncodeFields, SameBytesWithOneThreadAndWithTwo) {
  const std::vector<FieldSource> fields = {synthetic::field({8, 4}, 48, 40), synthetic::field({3}, 50, 40)};
  std::vector<std::vector<EncodedField>> runs;
  for (const size_t threads : {size_t{1}, size_t{2}}) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    runs.push_back(encode(fields, {.target_bytes = 9000}));
  }
  for (size_t r = 1; r < runs.size(); ++r) {
    for (size_t f = 0; f < fields.size(); ++f) {
      EXPECT_EQ(runs[r][f].nodes, runs[0][f].nodes);
      EXPECT_EQ(runs[r][f].contexts, runs[0][f].contexts);
      EXPECT_EQ(runs[r][f].node_units, runs[0][f].node_units);
      EXPECT_EQ(runs[r][f].squared_error, runs[0][f].squared_error);
    }
  }
}

TEST(EncodeFields, UnseenHalvesGoWithoutStorage) {
  FieldSource source = synthetic::field({8}, 128, 128);
  const auto seen = encode({source}, {.quantizer = 60});
  std::fill(source.importance[0].begin() + 128 * 64, source.importance[0].end(), 0.0f);
  const auto half = encode({source}, {.quantizer = 60});
  EXPECT_LT(static_cast<double>(half[0].nodes.size()), 0.75 * static_cast<double>(seen[0].nodes.size()));
  // What is not seen still looks like the object.
  const auto offsets = node_offsets(half[0]);
  const CodedPlanes leaf = leaf_of(source, half[0], offsets, 3), truth = source.load(3);
  source.importance[0].assign(source.importance[0].size(), 1.0f);
  EXPECT_LT(leaf_error(source, leaf, truth) / (128 * 128), 80 * 80);
}

TEST(EncodeFields, EmptyAndBlackInputs) {
  EXPECT_TRUE(encode({}, {.target_bytes = 100}).empty());
  FieldSource black = synthetic::field({4, 2}, 40, 40);
  black.load = [](int64_t) { return CodedPlanes(3 * 40 * 40, 0); };
  std::fill(black.importance[0].begin(), black.importance[0].end(), 0.0f);
  const auto encoded = encode({black}, {.target_bytes = 5000});
  EXPECT_TRUE(encoded[0].nodes.empty());
  expect_consistent(black, encoded[0]);
}

TEST(EncodeFields, StorageBelowTheTablesIsAnErrorThatSaysSo) {
  EXPECT_THROW(encode({synthetic::field({8, 8}, 32, 32)}, {.target_bytes = 300}), InputError);
}

TEST(PriceSearch, FindsTheRootOfAPowerLawInAFewSteps) {
  for (const double slope : {-0.3, -0.6, -1.1}) {
    PriceSearch search(50000);
    double price = 1;
    int steps = 0;
    const auto bytes = [&](double p) { return 1e7 * std::pow(p, slope); };
    while (std::fabs(bytes(price) / 50000 - 1) > 0.004 && ++steps < 12) price = search.next(price, bytes(price));
    EXPECT_LT(steps, 9) << slope;
  }
}

}  // namespace
}  // namespace vitrine
