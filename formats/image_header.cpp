// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/image_header.h"

#include <xxhash.h>

#include <cstring>

#include "formats/image.h"

namespace vitrine {
namespace {

// Byte offsets of the header's fields.
constexpr size_t kVersionAt = 8, kHeaderBytesAt = 12, kTotalBytesAt = 16, kDirectoryAt = 24, kDirectoryBytesAt = 32,
                 kDirectoryChecksumAt = 40, kDirectoryPlainBytesAt = 48, kHeaderChecksumAt = 56;

uint64_t read_little(std::span<const std::byte> bytes, size_t at, int width) {
  uint64_t value = 0;
  for (int i = width - 1; i >= 0; --i) value = value << 8 | std::to_integer<uint64_t>(bytes[at + static_cast<size_t>(i)]);
  return value;
}

void write_little(std::span<std::byte> bytes, size_t at, int width, uint64_t value) {
  for (int i = 0; i < width; ++i) bytes[at + static_cast<size_t>(i)] = static_cast<std::byte>(value >> 8 * i & 0xff);
}

Status check_sizes(const ImageHeader& header, uint64_t file_bytes) {
  if (header.total_bytes > file_bytes) return {StatusCode::kTruncated, "the file is shorter than its header says"};
  if (header.total_bytes < file_bytes) return {StatusCode::kMalformed, "bytes follow the end of the image"};
  if (header.directory_bytes > header.total_bytes - kHeaderBytes)
    return {StatusCode::kMalformed, "the directory does not lie in the file"};
  return {};
}

}  // namespace

uint64_t checksum_of(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

uint64_t aligned_offset(uint64_t offset) { return (offset + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment; }

Result<ImageHeader> read_header(std::span<const std::byte> file) {
  const size_t seen = file.size() < sizeof kImageMagic ? file.size() : sizeof kImageMagic;
  if (seen > 0 && std::memcmp(file.data(), kImageMagic, seen) != 0) return Status{StatusCode::kBadMagic, "not a Vitrine image"};
  if (file.size() < kHeaderBytes) return Status{StatusCode::kTruncated, "the file ends within its header"};
  ImageHeader header;
  header.version = static_cast<uint32_t>(read_little(file, kVersionAt, 4));
  // Before the checksum: a later version may have laid out the rest of its header otherwise.
  if (header.version < kOldestImageVersion || header.version > kImageVersion)
    return Status{StatusCode::kUnsupportedVersion, "the image is of a version that this engine does not read"};
  if (read_little(file, kHeaderChecksumAt, 8) != checksum_of(file.first(kHeaderChecksumAt)))
    return Status{StatusCode::kChecksumMismatch, "the header is damaged"};
  if (read_little(file, kHeaderBytesAt, 4) != kHeaderBytes || read_little(file, kDirectoryAt, 8) != kHeaderBytes)
    return Status{StatusCode::kMalformed, "the header contradicts its version"};
  header.total_bytes = read_little(file, kTotalBytesAt, 8);
  header.directory_bytes = read_little(file, kDirectoryBytesAt, 8);
  header.directory_checksum = read_little(file, kDirectoryChecksumAt, 8);
  header.directory_plain_bytes = read_little(file, kDirectoryPlainBytesAt, 8);
  if (Status status = check_sizes(header, file.size()); !status.ok()) return status;
  return header;
}

std::array<std::byte, kHeaderBytes> write_header(const ImageHeader& header) {
  std::array<std::byte, kHeaderBytes> bytes{};
  std::memcpy(bytes.data(), kImageMagic, sizeof kImageMagic);
  write_little(bytes, kVersionAt, 4, header.version);
  write_little(bytes, kHeaderBytesAt, 4, kHeaderBytes);
  write_little(bytes, kTotalBytesAt, 8, header.total_bytes);
  write_little(bytes, kDirectoryAt, 8, kHeaderBytes);
  write_little(bytes, kDirectoryBytesAt, 8, header.directory_bytes);
  write_little(bytes, kDirectoryChecksumAt, 8, header.directory_checksum);
  write_little(bytes, kDirectoryPlainBytesAt, 8, header.directory_plain_bytes);
  write_little(bytes, kHeaderChecksumAt, 8, checksum_of(std::span(bytes).first(kHeaderChecksumAt)));
  return bytes;
}

}  // namespace vitrine
