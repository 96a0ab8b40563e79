// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Images on disk or flash: mapped read-only, written atomically.
#pragma once

#include <cstddef>
#include <span>

#include "formats/status.h"

namespace vitrine::hal {

// A whole file mapped read-only; unmapped by the destructor. Movable.
class MappedFile {
 public:
  MappedFile() = default;
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();
  static Result<MappedFile> open(const char* path);  // regular files only; an empty file maps to an empty span
  std::span<const std::byte> bytes() const { return {data_, size_}; }

 private:
  const std::byte* data_ = nullptr;
  size_t size_ = 0;
};

// Replaces `path` by `bytes`: written beside it, synced, renamed. Whatever happens, `path` holds the old bytes or the new.
Status write_file_atomically(const char* path, std::span<const std::byte> bytes);

}  // namespace vitrine::hal
