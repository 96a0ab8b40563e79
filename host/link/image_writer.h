// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Puts a directory and its sections into a file (formats/SPEC.md, "Layout"). Checks nothing: link_image and the tests, which
// also write images that must be refused, call ImageView::open on the result. Header only, so that tests of the target's side
// can use it without linking the host.
#pragma once

#include <zstd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include "formats/image.h"
#include "formats/image_header.h"

namespace vitrine {

struct ImageSection {
  fb::SectionKind kind = fb::SectionKind::mesh;
  std::vector<std::byte> bytes;
};

// Fills the section table: `sections` laid out one after another.
inline void lay_out_sections(fb::ImageT& directory, const std::vector<ImageSection>& sections) {
  directory.sections.clear();
  uint64_t end = 0;
  for (const ImageSection& section : sections) {
    const uint64_t begin = aligned_offset(end);
    directory.sections.emplace_back(section.kind, begin, section.bytes.size(), checksum_of(section.bytes));
    end = begin + section.bytes.size();
  }
}

inline std::vector<std::byte> serialize_directory(const fb::ImageT& directory) {
  flatbuffers::FlatBufferBuilder builder;
  builder.Finish(fb::Image::Pack(builder, &directory));
  const auto* bytes = reinterpret_cast<const std::byte*>(builder.GetBufferPointer());
  return {bytes, bytes + builder.GetSize()};
}

inline constexpr int kSmallestCompression = 22, kFastCompression = 1;

// One frame; the same bytes each time.
inline std::vector<std::byte> compress(std::span<const std::byte> plain, int level = kSmallestCompression) {
  std::vector<std::byte> packed(ZSTD_compressBound(plain.size()));
  const size_t size = ZSTD_compress(packed.data(), packed.size(), plain.data(), plain.size(), level);
  if (ZSTD_isError(size)) throw std::bad_alloc();  // the only way to fail with room for the worst case
  packed.resize(size);
  return packed;
}

// The file of a serialized directory, whose section table is that of `sections`.
inline std::vector<std::byte> write_file(std::span<const std::byte> plain, const std::vector<ImageSection>& sections,
                                         int compression = kSmallestCompression) {
  const std::vector<std::byte> packed = compress(plain, compression);
  std::vector<std::byte> file(kHeaderBytes);
  const auto append = [&](std::span<const std::byte> bytes) {
    file.insert(file.end(), bytes.begin(), bytes.end());
    file.resize(aligned_offset(file.size()));
  };
  append(packed);
  for (const ImageSection& section : sections) append(section.bytes);
  const auto header = write_header({kImageVersion, file.size(), packed.size(), plain.size(), checksum_of(packed)});
  std::copy(header.begin(), header.end(), file.begin());
  return file;
}

// Replaces `directory.sections`.
inline std::vector<std::byte> write_image(fb::ImageT& directory, const std::vector<ImageSection>& sections) {
  lay_out_sections(directory, sections);
  return write_file(serialize_directory(directory), sections);
}

// A copy at a multiple of 64 bytes, as ImageView::open wants it, and of exactly the size of the original, so that address
// sanitizers see every read beyond it.
class AlignedBytes {
 public:
  explicit AlignedBytes(std::span<const std::byte> bytes) : size_(bytes.size()) {
    data_ = static_cast<std::byte*>(::operator new (size_, std::align_val_t{kSectionAlignment}));
    if (size_ > 0) std::memcpy(data_, bytes.data(), size_);
  }
  AlignedBytes(AlignedBytes&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  AlignedBytes(const AlignedBytes&) = delete;
  AlignedBytes& operator=(const AlignedBytes&) = delete;
  AlignedBytes& operator=(AlignedBytes&&) = delete;
  ~AlignedBytes() { ::operator delete (data_, std::align_val_t{kSectionAlignment}); }

  std::span<std::byte> bytes() { return {data_, size_}; }
  std::span<const std::byte> bytes() const { return {data_, size_}; }

 private:
  std::byte* data_ = nullptr;
  size_t size_ = 0;
};

}  // namespace vitrine
