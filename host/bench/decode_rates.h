// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How fast nodes decode: the pictures of an image's nodes through every design of coder, each at the same PSNR over all of
// them, one thread, node by node into a ring of planes as large as an engine's cache.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/base/progress.h"
#include "host/bench/node_pictures.h"

namespace vitrine {

// A design: has coded every picture, and decodes them one after another.
class NodeDesign {
 public:
  virtual ~NodeDesign() = default;
  virtual size_t coded_bytes(size_t picture) const = 0;
  // Bytes that decoding a picture writes, at most.
  virtual size_t decoded_bytes(size_t picture) const = 0;
  virtual void decode(size_t picture, std::byte* out) = 0;
  // What decode() left in `out`, as codes.
  virtual CodedPlanes planes_of(size_t picture, const std::byte* out) const = 0;
};

// The image's own bytes.
std::unique_ptr<NodeDesign> dct_design(std::span<const NodePicture> pictures);
// libjpeg-turbo, baseline with Huffman tables of each picture's own, three components of full size without any conversion of
// colours, raw planes out. A plane's values are shifted and scaled to 8 bits by its own range (never magnified), outside the
// measured time. Quantizers are flat: `scale` times the node's own steps.
std::unique_ptr<NodeDesign> jpeg_design(std::span<const NodePicture> pictures, double scale);

// The image's second coder, whatever the image was coded by: `scale` times the node's own steps, and the price that belongs to
// them; built-in contexts.
std::unique_ptr<NodeDesign> spiht_design(std::span<const NodePicture> pictures, double scale);

struct DecodeRate {
  std::string coder;
  double texels_s = 0, bytes_s = 0;  // decoded texels; bytes of decoded planes
  double relative = 0;               // texels_s, to that of libjpeg-turbo
  double share_of_copy = 0;          // bytes_s, to that of memcpy
  double bits_per_texel = 0;         // of coded bytes
  double psnr_db = 0;                // against 4095, squared errors of Y, Co, Cg as kPlaneWeights
};
struct DecodeRates {
  size_t nodes = 0, texels = 0;
  std::vector<DecodeRate> rows;
  // Nanoseconds a unit, of each node by itself: the mean over all, and the share of the units whose nodes lie within 15 % of it.
  double unit_ns = 0, units_within = 0;
};

// The best of `repetitions` rounds, in which designs take turns; processor time of this thread.
DecodeRates measure_decoding(std::span<const NodePicture> pictures, int repetitions, Progress& progress);

}  // namespace vitrine
