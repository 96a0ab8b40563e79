// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Initial states of contexts, fitted to the symbols of earlier encodings: nodes are so small (often a few hundred bytes)
// that learning from scratch in each would cost a good part of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/encode/node_encoder.h"

namespace vitrine {

// The states with which the given nodes would have cost least (probability and speed, per context). A context keeps the state
// of `before` unless another saves more than a change takes in the image
// (formats/context_changes.h). `before`: a byte a context. `share`: of all nodes that will be coded with these states, how much
// is given.
std::vector<uint8_t> train_contexts(const std::vector<const CodedSymbols*>& nodes, std::span<const uint8_t> before, double share);

}  // namespace vitrine
