// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Encodes one node of the SPIHT coder: rate-distortion optimized choice of what becomes significant, then bit plane by bit
// plane.
#pragma once

#include <cstdint>
#include <memory>

#include "formats/spiht_coding.h"
#include "host/encode/node_encoder.h"

namespace vitrine {

// Holds scratch memory; use one per thread.
class SpihtEncoder {
 public:
  SpihtEncoder();
  ~SpihtEncoder();
  // As NodeEncoder::encode; `task.contexts` are kSpihtContextCount bytes. Codes down to the task's steps, or as far as
  // `most_bytes` reach. `cell_weights` count where it is chosen what is worth coding; the decoder does not know them.
  NodeCode encode(const NodeTask& task, CodedSymbols* symbols = nullptr, size_t most_bytes = SIZE_MAX);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vitrine
