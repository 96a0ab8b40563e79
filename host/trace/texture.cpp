// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/texture.h"

#include <algorithm>
#include <cmath>

namespace vitrine::trace {
namespace {

using Table = std::array<float, 256>;

Table make_srgb_table() {
  Table table{};
  for (size_t i = 0; i < 256; ++i) {
    const double c = static_cast<double>(i) / 255;
    table[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
  }
  return table;
}
Table make_linear_table() {
  Table table{};
  for (size_t i = 0; i < 256; ++i) table[i] = static_cast<float>(i) / 255;
  return table;
}
const Table kLinear = make_linear_table();
const Table kSrgb = make_srgb_table();

int wrap(int i, int size, Wrap mode) {
  if (i >= 0 && i < size) return i;
  if (mode == Wrap::kClamp) return std::clamp(i, 0, size - 1);
  const int period = mode == Wrap::kMirror ? 2 * size : size;
  const int m = ((i % period) + period) % period;
  return m < size ? m : 2 * size - 1 - m;
}

glm::vec4 texel(const Image& image, int x, int y, const Table& rgb) {
  const uint8_t* t = &image.rgba[4 * (static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x))];
  return {rgb[t[0]], rgb[t[1]], rgb[t[2]], kLinear[t[3]]};
}

// Far coordinates come near first, to where the wrap mode shows the same, so that texel numbers (sides are at most 16384) fit
// an int.
float sane(float t, Wrap mode) {
  if (!std::isfinite(t)) return 0;
  if (std::fabs(t) < 1e4f) return t;
  return mode == Wrap::kClamp ? std::copysign(2.0f, t) : std::fmod(t, 2.0f);
}

glm::vec4 fetch(const Scene& scene, const TextureRef& ref, const TexCoords& uv, const Table& rgb) {
  const Image& image = scene.images[static_cast<size_t>(ref.image)];
  if (image.width <= 0 || image.height <= 0) return glm::vec4(1);
  const glm::vec3 st = ref.transform * glm::vec3(uv[ref.texcoord == 1 ? 1 : 0], 1);
  const float x = sane(st.x, ref.wrap_s) * static_cast<float>(image.width);
  const float y = sane(st.y, ref.wrap_t) * static_cast<float>(image.height);
  if (ref.nearest) {
    return texel(image, wrap(static_cast<int>(std::floor(x)), image.width, ref.wrap_s),
                 wrap(static_cast<int>(std::floor(y)), image.height, ref.wrap_t), rgb);
  }
  const float fx = std::floor(x - 0.5f), fy = std::floor(y - 0.5f);
  const float s = x - 0.5f - fx, t = y - 0.5f - fy;
  const int x0 = wrap(static_cast<int>(fx), image.width, ref.wrap_s),
            x1 = wrap(static_cast<int>(fx) + 1, image.width, ref.wrap_s);
  const int y0 = wrap(static_cast<int>(fy), image.height, ref.wrap_t),
            y1 = wrap(static_cast<int>(fy) + 1, image.height, ref.wrap_t);
  const glm::vec4 top = (1 - s) * texel(image, x0, y0, rgb) + s * texel(image, x1, y0, rgb);
  const glm::vec4 bottom = (1 - s) * texel(image, x0, y1, rgb) + s * texel(image, x1, y1, rgb);
  return (1 - t) * top + t * bottom;
}

}  // namespace

glm::vec4 fetch_linear(const Scene& scene, const TextureRef& reference, const TexCoords& uv) {
  return fetch(scene, reference, uv, kLinear);
}

glm::vec4 fetch_srgb(const Scene& scene, const TextureRef& reference, const TexCoords& uv) {
  return fetch(scene, reference, uv, kSrgb);
}

}  // namespace vitrine::trace
