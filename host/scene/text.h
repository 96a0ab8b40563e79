// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Words from files in messages to people: always on one line, never longer than a line bears.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace vitrine {

// `text` fit for a one-line message: control characters become '?', what exceeds `longest` bytes becomes "...".
std::string printable(std::string_view text, size_t longest = 80);
// printable() in double quotes.
std::string in_quotes(std::string_view text);
// The entry of `known` with the smallest edit distance to `word` (Levenshtein); empty when `known` is.
std::string nearest_word(std::string_view word, const std::vector<std::string>& known);
// "a, b, c", the first `most` of them.
std::string joined(const std::vector<std::string>& words, size_t most = 12);

}  // namespace vitrine
