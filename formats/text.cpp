// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/text.h"

#include <cstddef>
#include <cstdint>

namespace vitrine {
namespace {

// Bytes of the sequence that `lead` begins; 0 where none does.
int sequence_length(uint8_t lead) {
  if (lead < 0x80) return 1;
  if (lead >= 0xc2 && lead < 0xe0) return 2;
  if (lead >= 0xe0 && lead < 0xf0) return 3;
  if (lead >= 0xf0 && lead < 0xf5) return 4;
  return 0;
}

bool allowed(uint32_t c, int length) {
  if (c < 0x20 || (c >= 0x7f && c < 0xa0)) return false;
  if (length == 3) return c >= 0x800 && (c < 0xd800 || c > 0xdfff);
  if (length == 4) return c >= 0x10000 && c <= 0x10ffff;
  return true;
}

}  // namespace

bool is_plain_text(std::string_view text) {
  size_t at = 0;
  while (at < text.size()) {
    const uint8_t lead = static_cast<uint8_t>(text[at]);
    const int length = sequence_length(lead);
    if (length == 0 || text.size() - at < static_cast<size_t>(length)) return false;
    uint32_t c = length == 1 ? lead : lead & (0x7fu >> length);
    for (int i = 1; i < length; ++i) {
      const uint8_t next = static_cast<uint8_t>(text[at + static_cast<size_t>(i)]);
      if ((next & 0xc0u) != 0x80u) return false;
      c = c << 6 | (next & 0x3fu);
    }
    if (!allowed(c, length)) return false;
    at += static_cast<size_t>(length);
  }
  return !text.empty();
}

}  // namespace vitrine
