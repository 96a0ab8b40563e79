// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How a texture should lie on what some views show of a surface, with as few texels as will do (Hakura 2001, section 3.2): a
// branch cut where a gap allows one, the most isometric linear map from texture to screen, more texels where the screen would
// stretch them too far, and the smallest rectangle around what is seen.
#pragma once

#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "formats/texture_map.h"
#include "host/infer/inference.h"
#include "host/infer/visible_surface.h"

namespace vitrine {

// From unwrapped mesh coordinates to texels: `linear` * (u, v) - low lies in [0, size] for all that is seen.
struct TextureFit {
  glm::vec2 cut{0};
  glm::mat2 linear{1};
  glm::vec2 low{0}, size{0};
};
// `surface` is visible. `aspect`: width over height of the rectangle that it must go into, at least 1; 0: any.
TextureFit fit_texture(const VisibleSurface& surface, const TextureFitOptions& options, float aspect = 0);

// What a patch takes, estimated: texels, and half of its rectangle's circumference in texels, where these have unit mean square
// on the screen; 0 where nothing is seen.
struct PatchDemand {
  double texels = 0, girth = 0;
};
PatchDemand demand_of(const VisibleSurface& patch);

// Texels along u and v that the whole domain [0, 1]^2 needs where it is only scaled, to the same options.
glm::vec2 whole_domain_size(const VisibleSurface& surface, const TextureFitOptions& options);

// A rectangle of a texture, in texels.
struct TextureSlot {
  glm::ivec2 low{0}, size{0};
};
// The fit stretched or squeezed to fill a slot of a texture.
PatchMap map_of(const TextureFit& fit, const TextureSlot& slot, const TextureSize& texture);

inline constexpr int kTextureMargin = 2;  // texels between what is seen and a texture's border
// Texels between what is seen of two patches: as at two borders, on the level whose texels are as large as pixels.
int gutter_of(const TextureFitOptions& options);

// ---- the steps, for tests ----

// Where to cut a dimension: in the middle of the widest gap between triangles of which something is seen, 0 if that gap
// lies around the domain's border or there is none.
float branch_cut(const VisibleSurface& surface, int dimension);

// Equation 3.1: how far from lengths on the screen those in the texture are, along steps from pixel to pixel (axes and diagonals)
// in place of the edges of triangles, which say nothing of a large one's inside. `gradient`: d/d linear, may be null.
double isometry_error(std::span<const SurfaceSample> samples, const glm::dmat2& linear, glm::dmat2* gradient);
// Its minimum, by conjugate gradients; without a rotation, which the error does not see. kScales: u and v are only scaled.
enum class MapKind : uint8_t { kLinear, kScales };
glm::mat2 most_isometric_map(std::span<const SurfaceSample> samples, MapKind kind = MapKind::kLinear);

// The greatest stretch of a texel on the screen that `share` of the samples keep to, in pixels, and its direction in the texture.
struct Stretch {
  float pixels = 0;
  glm::vec2 direction{1, 0};
};
Stretch greatest_stretch(std::span<const SurfaceSample> samples, const glm::mat2& linear, float share);

// The turn (anticlockwise, radians in [0, pi)) after which the points' bounding rectangle is smallest and no taller than wide;
// where an aspect is given, the smallest rectangle of that aspect around it.
struct Rectangle {
  float turn = 0;
  glm::vec2 low{0}, size{0};  // of the points
  double texels = 0;          // of the rectangle that counts
};
Rectangle smallest_rectangle(std::span<const glm::vec2> points, float aspect = 0);

}  // namespace vitrine
