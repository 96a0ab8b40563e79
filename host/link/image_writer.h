// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Puts a directory and its sections into a file (formats/SPEC.md, "Layout"). Checks nothing: link_image and the tests, which
// also write images that must be refused, call ImageView::open on the result. Header only, so that tests of the target's side
// can use it without linking the host.
#pragma once

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
  fb::SectionKind kind = fb::SectionKind::vertices;
  std::vector<std::byte> bytes;
};

// Serialized directory whose section table describes `sections` laid out one after another, behind a directory of
// `directory_bytes`.
inline std::vector<std::byte> pack_directory(fb::ImageT& directory, const std::vector<ImageSection>& sections,
                                             uint64_t directory_bytes) {
  directory.sections.clear();
  uint64_t end = kHeaderBytes + directory_bytes;
  for (const ImageSection& section : sections) {
    const uint64_t begin = aligned_offset(end);
    directory.sections.emplace_back(section.kind, begin, section.bytes.size(), checksum_of(section.bytes));
    end = begin + section.bytes.size();
  }
  flatbuffers::FlatBufferBuilder builder;
  builder.Finish(fb::Image::Pack(builder, &directory));
  const auto* bytes = reinterpret_cast<const std::byte*>(builder.GetBufferPointer());
  return {bytes, bytes + builder.GetSize()};
}

// Replaces `directory.sections`. The table's size depends on the number of sections alone, so the first packing tells how
// large the second will be.
inline std::vector<std::byte> write_image(fb::ImageT& directory, const std::vector<ImageSection>& sections) {
  const uint64_t directory_bytes = pack_directory(directory, sections, 0).size();
  const std::vector<std::byte> packed = pack_directory(directory, sections, directory_bytes);
  const uint64_t end =
      sections.empty() ? kHeaderBytes + packed.size() : directory.sections.back().offset() + directory.sections.back().size();
  std::vector<std::byte> file(aligned_offset(end));
  const auto put = [&](uint64_t offset, std::span<const std::byte> bytes) {
    if (!bytes.empty()) std::memcpy(file.data() + offset, bytes.data(), bytes.size());
  };
  put(0, write_header({kImageVersion, file.size(), packed.size(), checksum_of(packed)}));
  put(kHeaderBytes, packed);
  for (size_t i = 0; i < sections.size(); ++i) put(directory.sections[i].offset(), sections[i].bytes);
  return file;
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
