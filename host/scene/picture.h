// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Decoding pictures that glTF carries: PNG and JPEG (stb_image), WebP (libwebp).
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>

#include "host/scene/scene.h"

namespace vitrine {

inline constexpr int kLargestPictureSide = 16384;
inline constexpr int64_t kLargestPicture = int64_t{64} << 20;  // pixels

// What kind of picture it is, is told by its first bytes. 16 bits are reduced to 8; grey becomes RGB; alpha is 255 where
// there is none. Throws std::runtime_error with one clause ("is not a PNG, JPEG or WebP picture").
Image decode_picture(std::span<const uint8_t> bytes);

}  // namespace vitrine
