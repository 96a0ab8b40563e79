// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Small sets of whole numbers along one axis: what a window that may wrap around holds.
#pragma once

#include <algorithm>
#include <array>

namespace vitrine {

struct Interval {
  int first = 0, last = -1;  // both included
};

// Disjoint intervals in ascending order.
struct IntervalSet {
  std::array<Interval, 4> parts{};
  int count = 0;

  // `first` must not be below that of the last part; overlapping and touching intervals become one.
  void add(int first, int last) {
    if (last < first) return;
    if (count > 0 && first <= parts[count - 1].last + 1)
      parts[count - 1].last = std::max(parts[count - 1].last, last);
    else
      parts[count++] = {first, last};
  }
  int size() const {
    int n = 0;
    for (int i = 0; i < count; ++i) n += parts[i].last - parts[i].first + 1;
    return n;
  }
};

inline IntervalSet intersection(const IntervalSet& a, const IntervalSet& b) {
  IntervalSet both;
  for (int i = 0; i < a.count; ++i)
    for (int j = 0; j < b.count; ++j)
      both.add(std::max(a.parts[i].first, b.parts[j].first), std::min(a.parts[i].last, b.parts[j].last));
  return both;
}

}  // namespace vitrine
