// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The colour transform of coded nodes: YCoCg by lifting, exactly invertible in integers (Malvar and Sullivan 2003,
// "YCoCg-R"). Nodes, sums of levels and caches live in (Y, Co, Cg); a leaf returns to R, G, B codes at the very end.
//
// And the curve of sRGB displays (IEC 61966-2-1), host side: it uses pow. Light and codes are shares of display white in
// [0, 1]. T is float or double, and all is computed in it.
#pragma once

#include <cmath>
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

template <typename T>
T srgb_from_linear(T light) {
  return light <= T(0.0031308) ? T(12.92) * light : T(1.055) * std::pow(light, 1 / T(2.4)) - T(0.055);
}
template <typename T>
T linear_from_srgb(T code) {
  return code <= T(0.04045) ? code / T(12.92) : std::pow((code + T(0.055)) / T(1.055), T(2.4));
}
// The derivative of srgb_from_linear.
template <typename T>
T srgb_slope(T light) {
  return light <= T(0.0031308) ? T(12.92) : (T(1.055) / T(2.4)) * std::pow(light, 1 / T(2.4) - 1);
}

}  // namespace vitrine
