// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Procedural textures for the tests of coders: a static albedo with grain, a soft shadow and highlights that move with the
// parameters at their own speeds, as codes in Y, Co, Cg.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "formats/color.h"
#include "formats/companding.h"
#include "formats/parameter_space.h"
#include "host/base/field_blocks.h"
#include "host/encode/encode.h"

namespace vitrine::synthetic {

inline float hash01(uint32_t x, uint32_t y) {
  uint32_t h = x * 0x9e3779b1u ^ (y + 0x7f4a7c15u) * 0x85ebca6bu;
  h = (h ^ (h >> 15)) * 0xc2b2ae35u;
  return static_cast<float>((h ^ (h >> 13)) >> 8) / 16777216.0f;
}

// Value noise, smooth at `scale` texels.
inline float noise(float x, float y, float scale, uint32_t seed) {
  const float u = x / scale, v = y / scale, iu = std::floor(u), iv = std::floor(v);
  const float fu = u - iu, fv = v - iv, su = fu * fu * (3 - 2 * fu), sv = fv * fv * (3 - 2 * fv);
  const auto at = [&](float a, float b) {
    return hash01(static_cast<uint32_t>(static_cast<int>(a)) + seed * 101, static_cast<uint32_t>(static_cast<int>(b)) + seed);
  };
  return (at(iu, iv) * (1 - su) + at(iu + 1, iv) * su) * (1 - sv) + (at(iu, iv + 1) * (1 - su) + at(iu + 1, iv + 1) * su) * sv;
}

struct Look {
  float grain = 0.15f;                       // contrast of the static pattern
  std::array<float, kMaxAxes> speed{24, 6};  // texels that highlights move per sample of each axis
  float highlight = 1.5f;                    // peak radiance
  float size = 9;                            // radius of the sharpest highlight, texels
  float reflection = 0.3f;                   // radiance of a sharp-edged picture that moves with the highlights
  uint32_t seed = 1;
};

inline CodedPlanes texture(int width, int height, const Look& look, const GridIndex& sample) {
  const size_t texels = static_cast<size_t>(width) * static_cast<size_t>(height);
  CodedPlanes planes(3 * texels);
  float shift = 0, turn = 0;
  for (size_t a = 0; a < kMaxAxes; ++a) {
    shift += look.speed[a] * static_cast<float>(sample[a]);
    turn += look.speed[a] * static_cast<float>(sample[a]) * (a % 2 ? 1.0f : -0.4f);
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float fx = static_cast<float>(x), fy = static_cast<float>(y);
      const float pattern =
          noise(fx + 2 * noise(fx, fy, 17, 7), fy * 0.15f, 5, look.seed) * 0.7f + noise(fx, fy, 3, look.seed + 5) * 0.3f;
      const float albedo = 0.25f + look.grain * (pattern - 0.5f);
      const float shadow =
          1 / (1 + std::exp(-(fx - 0.5f * static_cast<float>(width) - 0.6f * shift + 10 * std::sin(fy / 30)) / 6));
      float light = 0.2f + 0.8f * shadow, gloss = 0;
      for (int h = 0; h < 5; ++h) {
        const float cx = std::fmod(static_cast<float>(width) * (0.17f * static_cast<float>(h) + 0.1f) +
                                       shift * (1 + 0.15f * static_cast<float>(h)) + 4096,
                                   static_cast<float>(width));
        const float cy = static_cast<float>(height) * (0.2f + 0.15f * static_cast<float>(h)) + 0.5f * turn;
        const float r = look.size * (1 + static_cast<float>(h)), dx = (fx - cx) / r, dy = (fy - cy) / (1.6f * r);
        gloss += std::exp(-(dx * dx + dy * dy)) / (1 + static_cast<float>(h));
      }
      const float mirrored = noise(fx - shift + 4096, fy + 0.5f * turn + 4096, 14, look.seed + 9);
      const float g = look.highlight * gloss + look.reflection / (1 + std::exp(-(mirrored - 0.55f) * 60));
      const Ycocg c =
          ycocg_from_rgb({code_from_radiance(albedo * light * 1.2f + g), code_from_radiance(albedo * light * 0.9f + g * 0.95f),
                          code_from_radiance(albedo * light * 0.6f + g * 0.85f)});
      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
      planes[i] = static_cast<int16_t>(c.y);
      planes[texels + i] = static_cast<int16_t>(c.co);
      planes[2 * texels + i] = static_cast<int16_t>(c.cg);
    }
  }
  return planes;
}

inline FieldSource field(const std::vector<int>& samples, int width, int height, const Look& look = {}) {
  FieldSource source;
  source.space.axis_count = static_cast<int>(samples.size());
  for (size_t a = 0; a < samples.size(); ++a) source.space.axes[a].samples = samples[a];
  source.block_size = block_size_of(source.space);
  source.width = width;
  source.height = height;
  source.importance.assign(static_cast<size_t>(width) * static_cast<size_t>(height), 1.0f);
  source.load = [space = source.space, width, height, look](int64_t flat) {
    return texture(width, height, look, space.index_from_flat(flat));
  };
  return source;
}

}  // namespace vitrine::synthetic
