// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Decodes one node of the DCT coder: a 2D picture of three planes (Y, Co, Cg) of signed 16-bit values. Integers only,
// bit-exact on every machine. The bitstream is described in formats/SPEC.md. Works in steps, so that the engine can stop at
// the budget's edge and go on in a later frame. Allocates nothing; safe on hostile bytes (a damaged node decodes to an error
// or to some picture, never beyond `planes`, and in bounded time).
#pragma once

#include <cstdint>
#include <span>

#include "formats/status.h"

namespace vitrine {

// Everything about a node that does not stand in its own bytes.
struct NodeDesc {
  int width = 0, height = 0;
  uint16_t steps[3] = {1, 1, 1};             // quantizer step per plane
  std::span<const uint8_t> contexts;         // initial states of this level's contexts (formats/node_coding.h)
};

class NodeDecoder {
 public:
  // `planes`: 3 * width * height values, plane-major, rows from v = 0; need not be initialized. An empty `bytes` is the
  // all-zero node. Spans must live until done() or the next start().
  Status start(const NodeDesc& desc, std::span<const std::byte> bytes, std::span<int16_t> planes);
  // Decodes tiles until at least `units` more are spent or the node is done; returns the units spent (>= 1 unless done).
  // The sum over all steps of a node is exactly the units that the encoder declared; anything else is kMalformed.
  Result<uint64_t> step(uint64_t units);
  bool done() const { return done_; }

 private:
  // State of the coder: defined by the implementation, plain data, no pointers into itself.
  bool done_ = true;
};

}  // namespace vitrine
