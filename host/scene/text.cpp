// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/text.h"

#include <algorithm>
#include <numeric>

namespace vitrine {
namespace {

constexpr size_t kLongestCompared = 64;  // the distance is quadratic; longer words are compared by their beginning

size_t edit_distance(std::string_view a, std::string_view b) {
  a = a.substr(0, kLongestCompared);
  b = b.substr(0, kLongestCompared);
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t diagonal = row[0]++;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t change = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({change, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

// Where to cut so that no UTF-8 sequence is torn.
size_t whole_characters(std::string_view text, size_t bytes) {
  while (bytes > 0 && (static_cast<unsigned char>(text[bytes]) & 0xC0) == 0x80) --bytes;
  return bytes;
}

}  // namespace

std::string printable(std::string_view text, size_t longest) {
  std::string line(text.size() > longest ? text.substr(0, whole_characters(text, longest)) : text);
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  return text.size() > longest ? line + "..." : line;
}

std::string in_quotes(std::string_view text) { return '"' + printable(text) + '"'; }

std::string nearest_word(std::string_view word, const std::vector<std::string>& known) {
  constexpr size_t kMostCompared = 10000;
  const auto end = known.begin() + static_cast<std::ptrdiff_t>(std::min(known.size(), kMostCompared));
  const auto best = std::min_element(known.begin(), end, [&](const std::string& a, const std::string& b) {
    return edit_distance(word, a) < edit_distance(word, b);
  });
  return best == end ? std::string() : *best;
}

std::string joined(const std::vector<std::string>& words, size_t most) {
  std::string line;
  for (size_t i = 0; i < std::min(most, words.size()); ++i) line += (i ? ", " : "") + printable(words[i]);
  return words.size() > most ? line + ", ..." : line;
}

}  // namespace vitrine
