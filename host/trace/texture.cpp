// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/texture.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "formats/color.h"

namespace vitrine::trace {
namespace {

using ByteTable = std::array<float, 256>;

template <typename Decode>
ByteTable make_table(const Decode& decode) {
  ByteTable table{};
  for (size_t i = 0; i < 256; ++i) table[i] = static_cast<float>(decode(static_cast<double>(i) / 255));
  return table;
}
// By encoding.
const std::array<ByteTable, 2> kDecode = {make_table([](double c) { return c; }), make_table(linear_from_srgb<double>)};

// sRGB codes of light in steps of 1 / 16384, finer than the darkest code.
constexpr int kLightSteps = 16384;
const std::vector<uint8_t>& srgb_codes() {
  static const std::vector<uint8_t> codes = [] {
    std::vector<uint8_t> table;
    for (int i = 0; i <= kLightSteps; ++i)
      table.push_back(static_cast<uint8_t>(std::lround(255 * srgb_from_linear(static_cast<double>(i) / kLightSteps))));
    return table;
  }();
  return codes;
}

int wrap(int i, int size, Wrap mode) {
  if (static_cast<unsigned>(i) < static_cast<unsigned>(size)) return i;
  if (mode == Wrap::kClamp) return std::clamp(i, 0, size - 1);
  const int period = mode == Wrap::kMirror ? 2 * size : size;
  const int m = ((i % period) + period) % period;
  return m < size ? m : 2 * size - 1 - m;
}

// Far coordinates come near first, to where the wrap mode shows the same, so that texel numbers (sides are at most 16384) fit
// an int.
float sane(float t, Wrap mode) {
  if (std::fabs(t) < 1e4f) return t;
  if (!std::isfinite(t)) return 0;
  return mode == Wrap::kClamp ? std::copysign(2.0f, t) : std::fmod(t, 2.0f);
}

int floor_to_int(float x) {
  const int i = static_cast<int>(x);
  return i - (static_cast<float>(i) > x);
}

// The mean of a box of texels, each channel in light.
void average(const uint8_t* rgba, int stride, int x0, int x1, int y0, int y1, const ByteTable& decode, bool srgb, uint8_t* out) {
  float sum[4] = {};
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const uint8_t* t = rgba + 4 * (static_cast<size_t>(y) * static_cast<size_t>(stride) + static_cast<size_t>(x));
      for (int c = 0; c < 3; ++c) sum[c] += decode[t[c]];
      sum[3] += kDecode[0][t[3]];
    }
  }
  const float scale = 1.0f / static_cast<float>((x1 - x0) * (y1 - y0));
  for (int c = 0; c < 4; ++c) {
    const float mean = sum[c] * scale;
    out[c] = srgb && c < 3 ? srgb_codes()[static_cast<size_t>(std::lround(mean * kLightSteps))]
                           : static_cast<uint8_t>(std::lround(255 * mean));
  }
}

// The level whose texels are as large as the footprint is narrow, in a picture of `size` texels: a texture that repeats often one
// way is as sharp the other way. u and v are taken to be at right angles in the world, as they mostly are.
size_t level_of(const glm::vec2& footprint, const glm::mat3& transform, const glm::vec2& size) {
  const glm::vec2 u = glm::vec2(transform[0]) * size, v = glm::vec2(transform[1]) * size;  // texels per unit of the coordinates
  const glm::vec2 extents = u * u * footprint.x + v * v * footprint.y;
  float narrow = std::min(extents.x, extents.y);
  if (const float skew = u.x * u.y * footprint.x + v.x * v.y * footprint.y;
      skew != 0) {  // rotated: the shorter axis of an ellipse
    const float mean = 0.5f * (extents.x + extents.y), half = 0.5f * (extents.x - extents.y);
    narrow = std::max(0.0f, mean - std::sqrt(half * half + skew * skew));
  }
  // Half the binary logarithm, rounded down, is half the exponent.
  const int level = (static_cast<int>(std::bit_cast<uint32_t>(narrow) >> 23) - 127) >> 1;
  return static_cast<size_t>(std::max(level, 0));
}

struct Used {
  std::vector<bool> linear, srgb;
};

// Pictures that are minified: normal maps are not, as their mean would be smoother than what they show.
Used minified_images(const Scene& scene) {
  Used used{std::vector<bool>(scene.images.size()), std::vector<bool>(scene.images.size())};
  const auto mark = [](std::vector<bool>& images, const TextureRef& ref) {
    if (ref) images[static_cast<size_t>(ref.image)] = true;
  };
  for (const Material& m : scene.materials) {
    for (const TextureRef* ref : {&m.base_color_texture, &m.specular_color_texture}) mark(used.srgb, *ref);
    for (const TextureRef* ref : {&m.metallic_roughness_texture, &m.specular_texture, &m.transmission_texture,
                                  &m.clearcoat_texture, &m.clearcoat_roughness_texture})
      mark(used.linear, *ref);
  }
  return used;
}

}  // namespace

Textures::Textures(const Scene& scene) {
  const Used used = minified_images(scene);
  for (const Encoding encoding : {kLinear, kSrgb}) {
    const std::vector<bool>& wanted = encoding == kSrgb ? used.srgb : used.linear;
    pyramids_[encoding].resize(scene.images.size());
    for (size_t i = 0; i < scene.images.size(); ++i) {
      const Image& image = scene.images[i];
      Pyramid& pyramid = pyramids_[encoding][i];
      pyramid.levels.push_back({image.width, image.height, image.rgba.data()});
      if (wanted[i]) build(image, encoding, pyramid);
    }
  }
}

void Textures::build(const Image& image, Encoding encoding, Pyramid& pyramid) {
  const ByteTable& decode = kDecode[encoding];
  srgb_codes();  // made before threads ask for it
  int width = image.width, height = image.height;
  while (width > 1 || height > 1) {
    const Level from = pyramid.levels.back();
    width = std::max(1, width / 2);
    height = std::max(1, height / 2);
    auto& to = pyramid.coarse.emplace_back(4 * static_cast<size_t>(width) * static_cast<size_t>(height));
    tbb::parallel_for(0, height, [&, width, height](int y) {
      for (int x = 0; x < width; ++x) {
        average(from.rgba, from.width, x * from.width / width, (x + 1) * from.width / width, y * from.height / height,
                (y + 1) * from.height / height, decode, encoding == kSrgb,
                &to[4 * (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x))]);
      }
    });
    pyramid.levels.push_back({width, height, to.data()});
  }
}

glm::vec4 Textures::fetch(const TextureRef& ref, const TexturePoint& point, Encoding encoding) const {
  const Pyramid& pyramid = pyramids_[encoding][static_cast<size_t>(ref.image)];
  const size_t set = ref.texcoord == 1 ? 1 : 0;
  size_t index = 0;
  if (point.footprint[set].x > 0 && pyramid.levels.size() > 1) {
    const Level& finest = pyramid.levels[0];
    const glm::vec2 size(static_cast<float>(finest.width), static_cast<float>(finest.height));
    index = std::min(level_of(point.footprint[set], ref.transform, size), pyramid.levels.size() - 1);
  }
  const Level& level = pyramid.levels[index];
  if (level.width <= 0 || level.height <= 0) return glm::vec4(1);
  const ByteTable& rgb = kDecode[encoding];
  const glm::vec2& uv = point.uv[set];
  const glm::mat3& m = ref.transform;
  const float x = sane(m[0][0] * uv.x + m[1][0] * uv.y + m[2][0], ref.wrap_s) * static_cast<float>(level.width);
  const float y = sane(m[0][1] * uv.x + m[1][1] * uv.y + m[2][1], ref.wrap_t) * static_cast<float>(level.height);
  const auto texel = [&](int i, int j) {
    const uint8_t* t = level.rgba + 4 * (static_cast<size_t>(j) * static_cast<size_t>(level.width) + static_cast<size_t>(i));
    return glm::vec4(rgb[t[0]], rgb[t[1]], rgb[t[2]], kDecode[0][t[3]]);
  };
  if (index == 0 ? ref.nearest : point.blurred) {
    return texel(wrap(floor_to_int(x), level.width, ref.wrap_s), wrap(floor_to_int(y), level.height, ref.wrap_t));
  }
  const int column = floor_to_int(x - 0.5f), row = floor_to_int(y - 0.5f);
  const float s = x - 0.5f - static_cast<float>(column), t = y - 0.5f - static_cast<float>(row);
  const int x0 = wrap(column, level.width, ref.wrap_s), x1 = wrap(column + 1, level.width, ref.wrap_s);
  const int y0 = wrap(row, level.height, ref.wrap_t), y1 = wrap(row + 1, level.height, ref.wrap_t);
  const glm::vec4 top = (1 - s) * texel(x0, y0) + s * texel(x1, y0);
  const glm::vec4 bottom = (1 - s) * texel(x0, y1) + s * texel(x1, y1);
  return (1 - t) * top + t * bottom;
}

glm::vec4 Textures::linear(const TextureRef& reference, const TexturePoint& point) const {
  return fetch(reference, point, kLinear);
}
glm::vec4 Textures::srgb(const TextureRef& reference, const TexturePoint& point) const { return fetch(reference, point, kSrgb); }

}  // namespace vitrine::trace
