// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/context_changes.h"

#include <algorithm>

#include "image_generated.h"

namespace vitrine {
namespace {

Status malformed() { return {StatusCode::kMalformed, "a field's contexts are not well formed"}; }

}  // namespace

Status expand_contexts(std::span<const uint8_t> changes, std::span<const uint8_t> built_in, std::span<uint8_t> contexts) {
  const size_t set = built_in.size();
  std::span<const uint8_t> before = built_in;
  const bool none = changes.empty();
  for (; contexts.size() >= set; before = contexts.first(set), contexts = contexts.subspan(set)) {
    std::copy(before.begin(), before.end(), contexts.begin());
    if (none) continue;
    if (changes.empty()) return malformed();
    const size_t count = changes[0];
    if (changes.size() < 1 + 2 * count) return malformed();
    for (size_t i = 0; i < count; ++i) {
      const uint8_t context = changes[1 + 2 * i];
      if (context >= set || (i > 0 && context <= changes[2 * i - 1])) return malformed();
      contexts[context] = changes[2 + 2 * i];
    }
    changes = changes.subspan(1 + 2 * count);
  }
  return changes.empty() ? Status{} : malformed();
}

std::span<const uint8_t> context_changes_of(const fb::Field& field) {
  if (!field.contexts()) return {};
  return {field.contexts()->data(), field.contexts()->size()};
}

std::vector<uint8_t> context_changes(std::span<const uint8_t> contexts, std::span<const uint8_t> built_in) {
  const size_t set = built_in.size();
  std::vector<uint8_t> changes;
  std::span<const uint8_t> before = built_in;
  for (; contexts.size() >= set; before = contexts.first(set), contexts = contexts.subspan(set)) {
    const size_t count_at = changes.size();
    changes.push_back(0);
    for (size_t c = 0; c < set; ++c) {
      if (contexts[c] == before[c]) continue;
      ++changes[count_at];
      changes.push_back(static_cast<uint8_t>(c));
      changes.push_back(contexts[c]);
    }
  }
  return changes;
}

}  // namespace vitrine
