// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include "host/base/error.h"
#include "host/bench/decode_rates.h"
#include "host/encode/field_coder.h"
#include "host/encode/spiht_encoder.h"
#include "target/decode/spiht_decoder.h"

namespace vitrine {
namespace {

class SpihtDesign : public NodeDesign {
 public:
  SpihtDesign(std::span<const NodePicture> pictures, double scale) : pictures_(pictures) {
    SpihtEncoder encoder;
    size_t scratch = 0;
    for (const NodePicture& picture : pictures) {
      NodeTask task = task_of(picture, scale);
      NodeCode code = encoder.encode(task);
      NodeDesc desc = picture.desc;
      std::copy(task.steps.begin(), task.steps.end(), desc.steps);
      desc.contexts = {};
      desc.units = code.units;
      coded_.push_back({desc, std::move(code.bytes)});
      scratch = std::max(scratch, spiht_scratch_words(desc.width, desc.height));
    }
    scratch_.resize(scratch);
  }

  size_t coded_bytes(size_t picture) const override { return coded_[picture].bytes.size(); }
  size_t decoded_bytes(size_t picture) const override { return kNodePlanes * sizeof(int16_t) * pictures_[picture].texels(); }
  void decode(size_t picture, std::byte* out) override {
    const Coded& node = coded_[picture];
    const std::span<int16_t> planes(reinterpret_cast<int16_t*>(out), kNodePlanes * pictures_[picture].texels());
    Status status = decoder_.start(node.desc, std::as_bytes(std::span(node.bytes)), planes, scratch_);
    while (status.ok() && !decoder_.done()) status = decoder_.step(~uint64_t{0}).status();
    if (!status.ok()) throw InputError("a node by SPIHT", status.detail(), "report it: its own decoder refuses it");
  }
  CodedPlanes planes_of(size_t picture, const std::byte* out) const override {
    const auto* values = reinterpret_cast<const int16_t*>(out);
    return {values, values + kNodePlanes * pictures_[picture].texels()};
  }

 private:
  struct Coded {
    NodeDesc desc;
    std::vector<uint8_t> bytes;
  };

  // The price of a bit that belongs to the node's steps.
  static NodeTask task_of(const NodePicture& picture, double scale) {
    NodeTask task;
    task.width = picture.desc.width;
    task.height = picture.desc.height;
    task.planes = picture.source;
    const double step = scale * picture.desc.steps[0] / kStepUnitsPerCode;
    for (size_t p = 0; p < kNodePlanes; ++p) {
      task.steps[p] = static_cast<uint16_t>(std::clamp(std::round(scale * picture.desc.steps[p]), 1.0, 65535.0));
      task.weights[p] = static_cast<float>(static_cast<double>(kPlaneWeights[p]) / (kPricePerStep2 * step * step));
    }
    return task;
  }

  std::span<const NodePicture> pictures_;
  std::vector<Coded> coded_;
  std::vector<uint16_t> scratch_;
  SpihtDecoder decoder_;
};

}  // namespace

std::unique_ptr<NodeDesign> spiht_design(std::span<const NodePicture> pictures, double scale) {
  return std::make_unique<SpihtDesign>(pictures, scale);
}

}  // namespace vitrine
