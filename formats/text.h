// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Names in an image are shown on terminals and in reports, and come from a file that nobody vouches for.
#pragma once

#include <string_view>

namespace vitrine {

// True for one or more characters of well-formed UTF-8 (RFC 3629: shortest forms, no surrogates, at most U+10FFFF) without
// control characters (U+0000..U+001F, U+007F..U+009F).
bool is_plain_text(std::string_view text);

}  // namespace vitrine
