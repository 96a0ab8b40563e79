// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/spiht_encoder.h"

#include <algorithm>

#include "formats/spiht_syntax.h"
#include "host/encode/range_encoder.h"
#include "host/encode/zerotree_search.h"
#include "target/decode/spiht_decoder.h"

namespace vitrine {
namespace {

// The writer that formats/spiht_syntax.h goes through.
struct SpihtWriter {
  RangeEncoder range;
  SpihtContextSet& contexts;
  const std::array<ZerotreePlane, kNodePlanes>& planes;
  CodedSymbols* symbols;

  bool bit(int context, bool value) {
    range.bit(contexts[static_cast<size_t>(context)], value);
    if (symbols) symbols->push_back(static_cast<uint16_t>(context << 1 | value));
    return value;
  }
  bool raw(bool value) {
    range.raw(value);
    return value;
  }
  static bool ended() { return false; }
  int bit_planes(int plane) const { return planes[static_cast<size_t>(plane)].bit_planes; }
  int set_top(int plane, size_t cell) const { return planes[static_cast<size_t>(plane)].set_top[cell]; }
  int descendants_top(int plane, size_t cell) const { return planes[static_cast<size_t>(plane)].descendants_top[cell]; }
  int value(int plane, size_t place) const { return planes[static_cast<size_t>(plane)].value[place]; }
};

}  // namespace

struct SpihtEncoder::Impl {
  SpihtLayout layout;
  SpihtContextSet contexts;
  std::vector<uint16_t> maps, scratch;
  std::vector<int16_t> values;
  SpihtDecoder decoder;

  void write(SpihtWriter& writer) {
    maps.assign(kNodePlanes * layout.map_cells, 0);
    values.assign(kNodePlanes * layout.texels(), 0);
    SpihtPlanes state;
    int highest = 0;
    for (size_t p = 0; p < kNodePlanes; ++p) {
      state.map[p] = maps.data() + p * layout.map_cells;
      state.value[p] = values.data() + p * layout.texels();
      highest = std::max(highest, writer.planes[p].bit_planes);
    }
    SpihtWalk walk(layout, state, writer);
    for (int p = 0; p < kNodePlanes; ++p) walk.code_bit_planes(p);
    const size_t top = static_cast<size_t>(layout.levels);
    for (int bit = highest - 1; bit >= 0; --bit)
      for (int p = 0; p < kNodePlanes; ++p) {
        if (writer.planes[static_cast<size_t>(p)].bit_planes <= bit) continue;
        for (int y = 0; y < layout.height[top]; ++y)
          for (int x = 0; x < layout.width[top]; ++x) walk.code_root(p, bit, x, y);
      }
  }

  // What the target makes of the bytes is what they are worth.
  void decode(const NodeTask& task, NodeCode& code) {
    NodeDesc desc;
    desc.width = task.width;
    desc.height = task.height;
    std::copy(task.steps.begin(), task.steps.end(), desc.steps);
    desc.contexts = task.contexts;
    scratch.resize(spiht_scratch_words(task.width, task.height));
    code.planes.resize(task.planes.size());
    code.units = 0;
    if (!decoder.start(desc, std::as_bytes(std::span(code.bytes)), code.planes, scratch).ok()) return;
    while (!decoder.done()) code.units += decoder.step(~uint64_t{0}).value();
  }
};

SpihtEncoder::SpihtEncoder() : impl_(std::make_unique<Impl>()) {}
SpihtEncoder::~SpihtEncoder() = default;

NodeCode SpihtEncoder::encode(const NodeTask& task, CodedSymbols* symbols, size_t most_bytes) {
  NodeCode code;
  impl_->layout = spiht_layout(task.width, task.height);
  load_spiht_contexts(task.contexts, impl_->contexts);
  const auto planes = search_zerotrees(task, impl_->layout, spiht_bit_costs(impl_->contexts));
  if (std::any_of(planes.begin(), planes.end(), [](const ZerotreePlane& p) { return p.bit_planes > 0; })) {
    SpihtWriter writer{RangeEncoder(code.bytes), impl_->contexts, planes, symbols};
    impl_->write(writer);
    writer.range.finish_embedded();
  }
  code.bytes.resize(std::min(code.bytes.size(), most_bytes));
  impl_->decode(task, code);
  return code;
}

}  // namespace vitrine
