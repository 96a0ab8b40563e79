// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The coders of nodes, and what differs between them outside of a node's own bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace vitrine {

// Numbered as NodeCoder of formats/image.fbs.
enum class NodeCoder : uint8_t { kDct, kSpiht };

// Bytes of a level's set of initial context states; a change to one names it in a byte (formats/context_changes.h).
inline constexpr size_t kMostContexts = 176;
size_t context_bytes_per_level(NodeCoder coder);
// The built-in states, as bytes.
std::span<const uint8_t> default_context_bytes(NodeCoder coder);

}  // namespace vitrine
