// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/compose.h"

#include <algorithm>
#include <bit>

#include "formats/color.h"
#include "target/mip.h"

namespace vitrine {
namespace {

constexpr size_t kChunk = 512;  // texels; what is between two passes over a chunk stays in the first cache
constexpr uint16_t kHalfOne = 0x3c00;

struct Codes {
  std::array<int16_t, kChunk> y, co, cg;
};

// In 16 bits, modulo 2^16: up to eight levels fit in any case (formats/node_coding.h).
void sum_levels(const LeafTerm& leaf, size_t plane, size_t first, size_t count, int16_t* sum) {
  std::fill_n(sum, count, int16_t{0});
  for (size_t l = 0; l < static_cast<size_t>(leaf.count); ++l) {
    const int16_t* level = leaf.planes[l] + plane + first;
    if (leaf.subtracted[l])
      for (size_t i = 0; i < count; ++i) sum[i] = static_cast<int16_t>(sum[i] - level[i]);
    else
      for (size_t i = 0; i < count; ++i) sum[i] = static_cast<int16_t>(sum[i] + level[i]);
  }
}

int16_t clamped(int code) { return static_cast<int16_t>(std::clamp(code, 0, kCodeMax)); }

void return_to_rgb(Codes& codes, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    const RgbCode rgb = rgb_from_ycocg({codes.y[i], codes.co[i], codes.cg[i]});
    codes.y[i] = clamped(rgb.r);
    codes.co[i] = clamped(rgb.g);
    codes.cg[i] = clamped(rgb.b);
  }
}

void expand(const int16_t* codes, size_t count, const RadianceTable& radiance, float weight, bool add, float* sum) {
  if (add)
    for (size_t i = 0; i < count; ++i) sum[i] += weight * radiance[static_cast<size_t>(codes[i])];
  else
    for (size_t i = 0; i < count; ++i) sum[i] = weight * radiance[static_cast<size_t>(codes[i])];
}

void add_leaf(const LeafTerm& leaf, size_t texels, size_t first, size_t count, const RadianceTable& radiance, bool add,
              const std::array<float*, 3>& rgb) {
  Codes codes;
  sum_levels(leaf, 0, first, count, codes.y.data());
  sum_levels(leaf, texels, first, count, codes.co.data());
  sum_levels(leaf, 2 * texels, first, count, codes.cg.data());
  return_to_rgb(codes, count);
  expand(codes.y.data(), count, radiance, leaf.weight, add, rgb[0] + first);
  expand(codes.co.data(), count, radiance, leaf.weight, add, rgb[1] + first);
  expand(codes.cg.data(), count, radiance, leaf.weight, add, rgb[2] + first);
}

void compose_finest(std::span<const LeafTerm> terms, size_t texels, const RadianceTable& radiance,
                    const std::array<float*, 3>& rgb) {
  for (size_t first = 0; first < texels; first += kChunk)
    for (size_t t = 0; t < terms.size(); ++t)
      add_leaf(terms[t], texels, first, std::min(kChunk, texels - first), radiance, t > 0, rgb);
}

// Half floats: 5 bits of exponent (bias 15), 10 of mantissa. Normal ones by rounding away 13 bits of the mantissa; subnormal
// ones (below 2^-14) by an addition that shifts them to the place where the sum's own rounding does it.
inline uint16_t half_of(float value) {
  constexpr uint32_t kSmallestNormal = 113u << 23, kBias = 112u << 10, kMagic = 126u << 23;
  const auto bits = std::bit_cast<uint32_t>(value);
  const uint32_t normal = ((bits + 0xfffu + (bits >> 13 & 1u)) >> 13) - kBias;
  const uint32_t subnormal = std::bit_cast<uint32_t>(value + std::bit_cast<float>(kMagic)) - kMagic;
  const uint32_t small = 0u - static_cast<uint32_t>(bits < kSmallestNormal);  // a mask: a branch would not vectorize
  return static_cast<uint16_t>((subnormal & small) | (normal & ~small));
}

// In chunks: conversion and interleaving each vectorize by themselves, and not together.
void write_halves(const std::array<const float*, 3>& rgb, size_t texels, uint16_t* halves) {
  std::array<std::array<uint16_t, kChunk>, 3> chunk;
  for (size_t first = 0; first < texels; first += kChunk) {
    const size_t count = std::min(kChunk, texels - first);
    for (size_t c = 0; c < 3; ++c) halves_from_floats({rgb[c] + first, count}, chunk[c].data());
    for (size_t i = 0; i < count; ++i, halves += 4) {
      halves[0] = chunk[0][i];
      halves[1] = chunk[1][i];
      halves[2] = chunk[2][i];
      halves[3] = kHalfOne;
    }
  }
}

}  // namespace

RadianceTable make_radiance_table() {
  RadianceTable table;
  std::transform(half_from_code().begin(), half_from_code().end(), table.begin(), float_from_half);
  return table;
}

size_t texels_with_mips(int width, int height) {
  size_t texels = 0;
  for (int level = mip_level_count(width, height); level > 0; --level, width = mip_size(width), height = mip_size(height))
    texels += static_cast<size_t>(width) * static_cast<size_t>(height);
  return texels;
}

void halves_from_floats(std::span<const float> values, uint16_t* halves) {
  for (size_t i = 0; i < values.size(); ++i) halves[i] = half_of(values[i]);
}

void compose_texture(std::span<const LeafTerm> terms, int width, int height, const RadianceTable& radiance,
                     std::span<float> scratch, std::span<uint16_t> texels) {
  const size_t all = texels_with_mips(width, height);
  std::array<float*, 3> rgb{scratch.data(), scratch.data() + all, scratch.data() + 2 * all};
  compose_finest(terms, static_cast<size_t>(width) * static_cast<size_t>(height), radiance, rgb);
  for (float* plane : rgb) {
    int w = width, h = height;
    for (int level = mip_level_count(width, height); level > 1; --level, w = mip_size(w), h = mip_size(h)) {
      float* coarser = plane + static_cast<size_t>(w) * static_cast<size_t>(h);
      decimate(plane, w, h, coarser);
      plane = coarser;
    }
  }
  write_halves({scratch.data(), scratch.data() + all, scratch.data() + 2 * all}, all, texels.data());
}

}  // namespace vitrine
