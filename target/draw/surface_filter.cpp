// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/draw/surface_filter.h"

namespace vitrine {
namespace {

constexpr char kBilinear[] = R"(
const int surface_taps = 1;
vec4 surface_tap(sampler2D texels, vec2 uv, int tap, out vec2 at) {
  at = uv;
  return textureLod(texels, uv, 0.0);
})";

constexpr char kTrilinear[] = R"(
const int surface_taps = 1;
vec4 surface_tap(sampler2D texels, vec2 uv, int tap, out vec2 at) {
  at = uv;
  return texture(texels, uv);
})";

// The footprint is as long as a pixel's step along the screen axis that moves farther through the texture, and as wide as the
// other. Taps stand along it as far apart as a texel of their level is wide; those of a round footprint all stand in its middle.
// (A macro, since literals join where they are written and no GLSL ES knows templates.)
#define VITRINE_ANISOTROPIC_TAP                                                     \
  "vec4 surface_tap(sampler2D texels, vec2 uv, int tap, out vec2 at) {\n"           \
  "  float taps = float(surface_taps);\n"                                           \
  "  vec2 size = vec2(textureSize(texels, 0));\n"                                   \
  "  vec2 across = dFdx(uv), up = dFdy(uv);\n"                                      \
  "  float a = length(across * size), b = length(up * size);\n"                     \
  "  float longer = max(max(a, b), 1e-8), texel = max(longer / taps, min(a, b));\n" \
  "  float spread = (float(tap) / (taps - 1.0) - 0.5) * (1.0 - texel / longer);\n"  \
  "  at = uv + spread * (a > b ? across : up);\n"                                   \
  "  return textureLod(texels, at, log2(texel));\n"                                 \
  "}\n"
constexpr char kAnisotropic2[] = "const int surface_taps = 2;\n" VITRINE_ANISOTROPIC_TAP;
constexpr char kAnisotropic4[] = "const int surface_taps = 4;\n" VITRINE_ANISOTROPIC_TAP;
#undef VITRINE_ANISOTROPIC_TAP

}  // namespace

int tap_count(SurfaceFilter filter) {
  return filter == SurfaceFilter::kAnisotropic2 ? 2 : filter == SurfaceFilter::kAnisotropic4 ? 4 : 1;
}

const char* surface_tap_source(SurfaceFilter filter) {
  switch (filter) {
    case SurfaceFilter::kBilinear:
      return kBilinear;
    case SurfaceFilter::kTrilinear:
      return kTrilinear;
    case SurfaceFilter::kAnisotropic2:
      return kAnisotropic2;
    case SurfaceFilter::kAnisotropic4:
      return kAnisotropic4;
  }
  return kTrilinear;
}

}  // namespace vitrine
