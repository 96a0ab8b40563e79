// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/decode_rates.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "host/base/error.h"
#include "host/bench/processor_time.h"
#include "host/encode/field_coder.h"

namespace vitrine {
namespace {

constexpr size_t kRingBytes = size_t{24} << 20;
constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kClose = 0.15;

class DctDesign : public NodeDesign {
 public:
  explicit DctDesign(std::span<const NodePicture> pictures) : pictures_(pictures) {}
  size_t coded_bytes(size_t picture) const override { return pictures_[picture].bytes.size(); }
  size_t decoded_bytes(size_t picture) const override { return kNodePlanes * sizeof(int16_t) * pictures_[picture].texels(); }
  void decode(size_t picture, std::byte* out) override {
    const NodePicture& node = pictures_[picture];
    Status status = decoder_.start(node.desc, node.bytes, {reinterpret_cast<int16_t*>(out), kNodePlanes * node.texels()});
    while (status.ok() && !decoder_.done()) status = decoder_.step(~uint64_t{0}).status();
    if (!status.ok()) throw InputError("the image", status.detail(), "compile it again");
  }
  CodedPlanes planes_of(size_t picture, const std::byte* out) const override {
    const auto* values = reinterpret_cast<const int16_t*>(out);
    return {values, values + kNodePlanes * pictures_[picture].texels()};
  }

 private:
  std::span<const NodePicture> pictures_;
  NodeDecoder decoder_;
};

// Where pictures are decoded to, one after another.
class Ring {
 public:
  std::byte* take(size_t bytes) {
    if (bytes > memory_.size()) memory_.resize(bytes);
    if (at_ + bytes > memory_.size()) at_ = 0;
    std::byte* place = memory_.data() + at_;
    at_ += (bytes + 63) / 64 * 64;
    return place;
  }

 private:
  std::vector<std::byte> memory_ = std::vector<std::byte>(kRingBytes);
  size_t at_ = 0;
};

double squared_error(const NodePicture& picture, const CodedPlanes& decoded) {
  double sum = 0;
  for (size_t i = 0; i < decoded.size(); ++i) {
    const double e = picture.source[i] - decoded[i];
    sum += static_cast<double>(kPlaneWeights[i / picture.texels()]) * e * e;
  }
  return sum / 3;
}

double psnr_of(std::span<const NodePicture> pictures, NodeDesign& design) {
  Ring ring;
  double error = 0, texels = 0;
  for (size_t i = 0; i < pictures.size(); ++i) {
    std::byte* out = ring.take(design.decoded_bytes(i));
    design.decode(i, out);
    error += squared_error(pictures[i], design.planes_of(i, out));
    texels += static_cast<double>(pictures[i].texels());
  }
  return 10 * std::log10(4095.0 * 4095.0 * texels / error);
}

using ScaledDesign = std::unique_ptr<NodeDesign> (*)(std::span<const NodePicture>, double scale);

// A design with the same PSNR, within what the whole numbers of its quantizers allow.
std::unique_ptr<NodeDesign> matched(ScaledDesign design, std::span<const NodePicture> pictures, double psnr, Progress& progress) {
  constexpr int kSteps = 9;
  double low = std::log(0.05), high = std::log(20.0);
  progress.begin("finding quantizers of equal PSNR", kSteps, 0, "steps");
  for (int i = 0; i < kSteps; ++i, progress.advance(1)) {
    const double middle = (low + high) / 2;
    (psnr_of(pictures, *design(pictures, std::exp(middle))) > psnr ? low : high) = middle;
  }
  progress.end();
  return design(pictures, std::exp(low));
}

struct Timed {
  std::string name;
  NodeDesign* design = nullptr;  // null: a plain copy of what `like` decodes
  NodeDesign* like = nullptr;
  double seconds = kNever;
};

void decode_all(const Timed& timed, size_t count, Ring& ring, Ring& source) {
  for (size_t i = 0; i < count; ++i) {
    const size_t bytes = (timed.design ? timed.design : timed.like)->decoded_bytes(i);
    std::byte* out = ring.take(bytes);
    if (timed.design)
      timed.design->decode(i, out);
    else
      std::memcpy(out, source.take(bytes), bytes);
  }
}

// A node's own nanoseconds: the least of all rounds, for others' work on the machine only adds.
void measure_units(std::span<const NodePicture> pictures, int repetitions, DecodeRates& rates) {
  const auto design = dct_design(pictures);
  std::vector<double> seconds(pictures.size(), kNever);
  Ring ring;
  for (int round = 0; round < repetitions; ++round)
    for (size_t i = 0; i < pictures.size(); ++i) {
      std::byte* out = ring.take(design->decoded_bytes(i));
      const double start = wall_seconds();
      design->decode(i, out);
      seconds[i] = std::min(seconds[i], wall_seconds() - start);
    }
  double all = 0, units = 0, within = 0;
  for (size_t i = 0; i < pictures.size(); ++i) all += seconds[i], units += static_cast<double>(pictures[i].desc.units);
  for (size_t i = 0; i < pictures.size(); ++i) {
    const double own = static_cast<double>(pictures[i].desc.units);
    if (std::fabs(seconds[i] / own / (all / units) - 1) <= kClose) within += own;
  }
  rates.unit_ns = 1e9 * all / units;
  rates.units_within = within / units;
}

DecodeRate rate_of(const Timed& timed, std::span<const NodePicture> pictures, double texels) {
  DecodeRate rate;
  rate.coder = timed.name;
  double coded = 0, decoded = 0;
  NodeDesign* design = timed.design ? timed.design : timed.like;
  for (size_t i = 0; i < pictures.size(); ++i) {
    if (timed.design) coded += static_cast<double>(design->coded_bytes(i));
    decoded += static_cast<double>(design->decoded_bytes(i));
  }
  rate.texels_s = texels / timed.seconds;
  rate.bytes_s = decoded / timed.seconds;
  rate.bits_per_texel = 8 * coded / texels;
  return rate;
}

}  // namespace

std::unique_ptr<NodeDesign> dct_design(std::span<const NodePicture> pictures) { return std::make_unique<DctDesign>(pictures); }

DecodeRates measure_decoding(std::span<const NodePicture> pictures, int repetitions, Progress& progress) {
  DecodeRates rates;
  rates.nodes = pictures.size();
  for (const NodePicture& picture : pictures) rates.texels += picture.texels();
  const auto dct = dct_design(pictures);
  const double psnr = psnr_of(pictures, *dct);
  const auto jpeg = matched(jpeg_design, pictures, psnr, progress), spiht = matched(spiht_design, pictures, psnr, progress);
  std::vector<Timed> designs = {
      {"dct", dct.get()}, {"libjpeg-turbo", jpeg.get()}, {"spiht", spiht.get()}, {"copy", nullptr, dct.get()}};
  Ring ring, source;
  progress.begin("decoding", repetitions, 0, "rounds");
  for (int round = 0; round < repetitions; ++round, progress.advance(1))
    for (Timed& timed : designs) {
      const double start = processor_seconds();
      decode_all(timed, pictures.size(), ring, source);
      timed.seconds = std::min(timed.seconds, processor_seconds() - start);
    }
  progress.end();
  for (const Timed& timed : designs) rates.rows.push_back(rate_of(timed, pictures, static_cast<double>(rates.texels)));
  for (size_t i = 0; i < designs.size(); ++i)
    if (designs[i].design) rates.rows[i].psnr_db = psnr_of(pictures, *designs[i].design);
  for (DecodeRate& row : rates.rows) {
    row.relative = row.texels_s / rates.rows[1].texels_s;
    row.share_of_copy = row.bytes_s / rates.rows.back().bytes_s;
  }
  measure_units(pictures, repetitions, rates);
  return rates;
}

}  // namespace vitrine
