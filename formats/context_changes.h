// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How an image holds the initial states of a field's contexts (formats/SPEC.md, "Contexts"): level by level, what differs
// from the level before, the first from the built-in states.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/status.h"

namespace vitrine {

namespace fb {
struct Field;
}

// Fills `contexts`, for each of its levels as many as there are built-in ones (formats/node_coder.h). No changes at all:
// built-in states throughout.
Status expand_contexts(std::span<const uint8_t> changes, std::span<const uint8_t> built_in, std::span<uint8_t> contexts);

// As a field of an image has them.
std::span<const uint8_t> context_changes_of(const fb::Field& field);

// The changes that expand to these.
std::vector<uint8_t> context_changes(std::span<const uint8_t> contexts, std::span<const uint8_t> built_in);

}  // namespace vitrine
