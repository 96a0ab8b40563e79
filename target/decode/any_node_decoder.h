// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Decodes a node of either coder.
#pragma once

#include <cstdint>
#include <span>

#include "formats/node_coder.h"
#include "target/decode/node_decoder.h"
#include "target/decode/spiht_decoder.h"

namespace vitrine {

class AnyNodeDecoder {
 public:
  // As NodeDecoder::start and SpihtDecoder::start; `scratch` is left alone by the DCT coder.
  Status start(NodeCoder coder, const NodeDesc& desc, std::span<const std::byte> bytes, std::span<int16_t> planes,
               std::span<uint16_t> scratch) {
    coder_ = coder;
    return coder == NodeCoder::kSpiht ? spiht_.start(desc, bytes, planes, scratch) : dct_.start(desc, bytes, planes);
  }
  Result<uint64_t> step(uint64_t units) { return coder_ == NodeCoder::kSpiht ? spiht_.step(units) : dct_.step(units); }
  bool done() const { return coder_ == NodeCoder::kSpiht ? spiht_.done() : dct_.done(); }

 private:
  NodeCoder coder_ = NodeCoder::kDct;
  NodeDecoder dct_;
  SpihtDecoder spiht_;
};

}  // namespace vitrine
