// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The forward wavelet of SPIHT nodes: what SpihtDecoder inverts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/spiht_coding.h"

namespace vitrine {

// One plane of texels (clamped to what a node can hold) as coefficients, with kWaveletFraction fractional bits, where SpihtLayout
// says that they stand.
std::vector<int16_t> forward_wavelet(const SpihtLayout& layout, std::span<const int16_t> texels);

}  // namespace vitrine
