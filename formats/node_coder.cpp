// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/node_coder.h"

#include "formats/node_coding.h"
#include "formats/spiht_coding.h"

namespace vitrine {

size_t context_bytes_per_level(NodeCoder coder) {
  return coder == NodeCoder::kSpiht ? kSpihtContextCount : kContextBytesPerLevel;
}

std::span<const uint8_t> default_context_bytes(NodeCoder coder) {
  return coder == NodeCoder::kSpiht ? default_spiht_context_bytes() : default_context_bytes();
}

}  // namespace vitrine
