// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Any bytes as a node of either coder: its description first, then its contexts, then what is coded. Whatever they are, planes of
// exactly the node's size suffice, values stay in range, units below what is declared, and a node that fails leaves nothing.
#include <cstdlib>
#include <cstring>
#include <vector>

#include "target/decode/any_node_decoder.h"

namespace vitrine {
namespace {

struct __attribute__((packed)) Header {
  uint8_t width, height;
  uint16_t steps[3];
  uint32_t units;
  uint16_t step_units;
  uint8_t wide, flags;

  bool own_contexts() const { return flags & 1; }
  NodeCoder coder() const { return flags & 2 ? NodeCoder::kSpiht : NodeCoder::kDct; }
};

void check(bool holds) {
  if (!holds) std::abort();
}

void decode(const Header& header, std::span<const uint8_t> contexts, std::span<const std::byte> bytes) {
  NodeDesc desc;
  // Small ones are quick; edges and several tiles lie in them too. A few are long.
  desc.width = header.width % (header.wide % 8 == 0 ? 8 : 72);
  desc.height = header.height % (header.wide % 8 == 1 ? 8 : 72);
  if (header.wide % 8 == 0) desc.height = 32 * header.height;
  if (header.wide % 8 == 1) desc.width = 32 * header.width;
  std::copy_n(header.steps, kNodePlanes, desc.steps);
  desc.units = header.units;
  desc.contexts = contexts;
  std::vector<int16_t> planes(kNodePlanes * static_cast<size_t>(desc.width) * static_cast<size_t>(desc.height), 77);
  std::vector<uint16_t> scratch(header.coder() == NodeCoder::kSpiht ? spiht_scratch_words(desc.width, desc.height) : 0);
  AnyNodeDecoder decoder;
  if (!decoder.start(header.coder(), desc, bytes, planes, scratch).ok()) return check(decoder.done());
  uint64_t spent = 0;
  while (!decoder.done()) {
    const Result<uint64_t> step = decoder.step(header.step_units);
    if (!step.ok()) {
      check(decoder.done());
      for (const int16_t value : planes) check(value == 0);
      return;
    }
    spent += step.value();
    check(desc.units == 0 || spent <= desc.units);
  }
  check(desc.units == 0 || spent == desc.units);
  for (const int16_t value : planes) check(value >= -kNodeValueMax && value <= kNodeValueMax);
}

}  // namespace
}  // namespace vitrine

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace vitrine;
  Header header;
  if (size < sizeof(header)) return 0;
  std::memcpy(&header, data, sizeof(header));
  std::vector<uint8_t> contexts, bytes(data + sizeof(header), data + size);  // of exactly their size, for the sanitizer
  const size_t own = context_bytes_per_level(header.coder());
  if (header.own_contexts() && bytes.size() >= own) {
    contexts.assign(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(own));
    bytes.erase(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(own));
  }
  decode(header, contexts, std::as_bytes(std::span(bytes)));
  return 0;
}
