// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How many frames of a coded video have to be decoded to see one of them, read off the stream itself.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace vitrine {

// A frame needs itself and all that others may refer to and that come before it, in decoding order, back to a key frame; the most
// that any frame needs. Streams of whole groups (no leading frames of open ones). Nothing but frames without a key frame: 0.
int decodes_of_h264(std::span<const std::byte> stream);   // Annex B
int decodes_of_hevc(std::span<const std::byte> stream);   // Annex B
int decodes_of_mpeg4(std::span<const std::byte> stream);  // Part 2, elementary

// The same of AV1, where every header says what its frame may refer to. `headers`: as ffmpeg's trace_headers prints them.
int decodes_of_av1(const std::string& headers);

}  // namespace vitrine
