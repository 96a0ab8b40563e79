// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Decodes the corpus and says whether everything comes out as it must: for machines that run no test framework
// (tests/golden/check_on_arm).
#include "tests/golden/node_corpus.h"

int main(int count, char** arguments) {
  const auto nodes = vitrine::golden::read_corpus(count > 1 ? arguments[1] : "");
  const auto different = vitrine::golden::different_nodes(nodes);
  for (const size_t i : different) std::printf("node %zu of %s comes out otherwise\n", i, arguments[1]);
  std::printf("%zu nodes, %zu of them otherwise than they must be\n", nodes.size(), different.size());
  return nodes.empty() || !different.empty();
}
