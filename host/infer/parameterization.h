// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The texture domain of an object: every point of its surface gets a place of its own in [0, 1]^2. TEXCOORD_0 is taken where
// it is such a parameterization already; most are not, because pictures repeat and mirrored halves share them. Otherwise one
// is made: charts grown over neighbouring triangles, projected along their mean normal, packed at one scale (charts.h,
// chart_packing.h). A mesh that falls into more than kMaxCharts charts is packed in pairs of triangles.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "host/infer/inference.h"
#include "host/scene/scene.h"

namespace vitrine {

inline constexpr size_t kMaxCharts = 4096;

// All coordinates finite and in [0, 1]; less than 1 % of the covered area covered twice; at most 5 % of the surface on
// triangles that get less than 1/400 of the mean area in the texture for their size.
bool is_proper_parameterization(const Geometry& geometry, const glm::mat4& world_from_object);

// Texture coordinates, three per triangle: TEXCOORD_0 or automatic. Lengths are those in the world.
std::vector<glm::vec2> texture_domain(const Geometry& geometry, const glm::mat4& world_from_object);

// An object as the target draws it, in its whole texture domain: vertices are split where texture coordinates part, and
// single-sided triangles come first (a material that is neither double-sided nor lets light through, in all variants).
// Texture sizes are 0 yet.
DrawnObject make_drawn_object(const Scene& scene, int object, const glm::mat4& world_from_object);

}  // namespace vitrine
