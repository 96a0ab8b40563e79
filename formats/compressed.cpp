// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/compressed.h"

#include <zstd.h>

namespace vitrine {

Status expand(std::span<const std::byte> packed, std::span<std::byte> plain) {
  // One frame: the library would go on through several, and those of nothing could be many.
  if (ZSTD_findFrameCompressedSize(packed.data(), packed.size()) != packed.size())
    return {StatusCode::kMalformed, "compressed data are not one frame"};
  const size_t size = ZSTD_decompress(plain.data(), plain.size(), packed.data(), packed.size());
  if (ZSTD_isError(size) || size != plain.size()) return {StatusCode::kMalformed, "compressed data cannot be expanded"};
  return {};
}

}  // namespace vitrine
