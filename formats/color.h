// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The colour transform of coded nodes: YCoCg by lifting, exactly invertible in integers (Malvar and Sullivan 2003,
// "YCoCg-R"). Nodes, sums of levels and caches live in (Y, Co, Cg); a leaf returns to R, G, B codes at the very end.
#pragma once

#include <cstdint>

namespace vitrine {

struct Ycocg { int y, co, cg; };
struct RgbCode { int r, g, b; };

inline Ycocg ycocg_from_rgb(RgbCode c) {
  const int co = c.r - c.b, t = c.b + (co >> 1), cg = c.g - t;
  return {t + (cg >> 1), co, cg};
}
inline RgbCode rgb_from_ycocg(Ycocg c) {
  const int t = c.y - (c.cg >> 1), g = c.cg + t, b = t - (c.co >> 1);
  return {b + c.co, g, b};
}

}  // namespace vitrine
