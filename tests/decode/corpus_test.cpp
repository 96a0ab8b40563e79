// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The checked-in corpus of nodes comes out the same with every kind of vectors that this machine has, and without any.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "tests/golden/node_corpus.h"

namespace vitrine {
namespace {

constexpr const char* kCorpus = VITRINE_SOURCE_DIR "/tests/golden/nodes.bin";

class Corpus : public testing::Test {
 protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_F(Corpus, DecodesToTheSameTexelsWithAllVectorsAndWithNone) {
  const auto nodes = golden::read_corpus(kCorpus);
  ASSERT_GE(nodes.size(), 30u);
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    EXPECT_EQ(golden::different_nodes(nodes), std::vector<size_t>()) << hwy::TargetName(target);
    std::printf("decoded with %s\n", hwy::TargetName(target));
  }
}

TEST_F(Corpus, HoldsDamagedNodesThatAreFoundOutAndLeaveNothing) {
  size_t malformed = 0;
  for (const golden::CorpusNode& node : golden::read_corpus(kCorpus)) {
    if (node.outcome != golden::Outcome::kMalformed) continue;
    ++malformed;
    const size_t values = 3 * static_cast<size_t>(node.desc.width) * static_cast<size_t>(node.desc.height);
    EXPECT_EQ(node.checksum, golden::checksum_of_planes(std::vector<int16_t>(values, 0)));
  }
  EXPECT_GE(malformed, 3u);
}

}  // namespace
}  // namespace vitrine
