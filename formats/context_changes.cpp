// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/context_changes.h"

#include <algorithm>

#include "formats/node_coding.h"
#include "image_generated.h"

namespace vitrine {
namespace {

constexpr size_t kSet = kContextBytesPerLevel;
static_assert(kSet <= 255, "a change names its context in a byte");

Status malformed() { return {StatusCode::kMalformed, "a field's contexts are not well formed"}; }

}  // namespace

Status expand_contexts(std::span<const uint8_t> changes, std::span<uint8_t> contexts) {
  std::span<const uint8_t> before = default_context_bytes();
  const bool none = changes.empty();
  for (; contexts.size() >= kSet; before = contexts.first(kSet), contexts = contexts.subspan(kSet)) {
    std::copy(before.begin(), before.end(), contexts.begin());
    if (none) continue;
    if (changes.empty()) return malformed();
    const size_t count = changes[0];
    if (changes.size() < 1 + 2 * count) return malformed();
    for (size_t i = 0; i < count; ++i) {
      const uint8_t context = changes[1 + 2 * i];
      if (context >= kSet || (i > 0 && context <= changes[2 * i - 1])) return malformed();
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

std::vector<uint8_t> context_changes(std::span<const uint8_t> contexts) {
  std::vector<uint8_t> changes;
  std::span<const uint8_t> before = default_context_bytes();
  for (; contexts.size() >= kSet; before = contexts.first(kSet), contexts = contexts.subspan(kSet)) {
    const size_t count_at = changes.size();
    changes.push_back(0);
    for (size_t c = 0; c < kSet; ++c) {
      if (contexts[c] == before[c]) continue;
      ++changes[count_at];
      changes.push_back(static_cast<uint8_t>(c));
      changes.push_back(contexts[c]);
    }
  }
  return changes;
}

}  // namespace vitrine
