// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The fixed header of an image (formats/SPEC.md, "Header") and the checksum of all its parts. Fields are read and written as
// little-endian bytes, whatever the machine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/status.h"

namespace vitrine {

inline constexpr size_t kHeaderBytes = 64;

struct ImageHeader {
  uint32_t version = 0;
  uint64_t total_bytes = 0;            // of the file
  uint64_t directory_bytes = 0;        // as it lies in the file
  uint64_t directory_plain_bytes = 0;  // expanded
  uint64_t directory_checksum = 0;
};

// XXH3-64 with seed 0.
uint64_t checksum_of(std::span<const std::byte> bytes);

// The next multiple of kSectionAlignment; `offset` is at most 2^63.
uint64_t aligned_offset(uint64_t offset);

// Checks magic, version, the header's checksum and the sizes against `file` (the whole file).
Result<ImageHeader> read_header(std::span<const std::byte> file);
// As read_header reads it: magic, constants and the header's checksum are filled in.
std::array<std::byte, kHeaderBytes> write_header(const ImageHeader& header);

}  // namespace vitrine
