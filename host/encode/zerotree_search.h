// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Which magnitudes a SPIHT node gets: rate-distortion optimized, tree by tree from the leaves up (space-frequency
// quantization, Xiong, Ramchandran and Orchard 1997), with the costs of symbols as the contexts have them to begin with.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/spiht_coding.h"
#include "host/encode/node_encoder.h"

namespace vitrine {

// One plane's decided magnitudes, and the highest bit planes of its trees.
struct ZerotreePlane {
  std::vector<int16_t> value;                    // signed, in steps, where SpihtLayout says
  std::vector<int8_t> set_top, descendants_top;  // per cell of the map: highest bit plane there; -1: all zero
  int bit_planes = 0;                            // of the largest magnitude
};

using SpihtBitCosts = std::array<std::array<float, 2>, kSpihtContextCount>;
SpihtBitCosts spiht_bit_costs(const SpihtContextSet& contexts);

std::array<ZerotreePlane, kNodePlanes> search_zerotrees(const NodeTask& task, const SpihtLayout& layout,
                                                        const SpihtBitCosts& costs);

}  // namespace vitrine
