// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/status.h"

namespace vitrine {

// An 8-bit RGB file in memory; empty where there is none left. `rgb`: width * height * 3 values, rows top first.
std::vector<std::byte> png_of(int width, int height, std::span<const uint8_t> rgb);

// Writes an 8-bit RGB file, atomically.
Status write_png(const std::string& path, int width, int height, std::span<const uint8_t> rgb);

// RGB rows top first, from RGBA rows bottom first as hal::Gpu::read_pixels gives them.
std::vector<uint8_t> rgb_from_read_back(int width, int height, std::span<const uint8_t> rgba);

}  // namespace vitrine
