// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// From a field's decoded nodes to its texture: sum the levels of each leaf, return to R, G, B codes, undo the companding, blend
// samples in linear light, make the MIP levels, round to half floats. The same bytes on every machine: integers up to the codes,
// then floats in one fixed order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/block.h"
#include "formats/companding.h"

namespace vitrine {

// One leaf and its weight in the blend.
struct LeafTerm {
  std::array<const int16_t*, kMaxLevels> planes{};  // of each node: Y, Co, Cg, each width * height
  std::array<bool, kMaxLevels> subtracted{};        // FieldShape::subtracts
  int count = 0;
  float weight = 1;
};

using RadianceTable = std::array<float, kCodeMax + 1>;
RadianceTable make_radiance_table();  // of half_from_code

size_t texels_with_mips(int width, int height);
// Floats that compose_texture needs beside its output.
inline size_t compose_scratch_floats(int width, int height) { return 3 * texels_with_mips(width, height); }

// Writes RGBA half floats (alpha 1) of level 0, then level 1, and so on down to 1 x 1: texels_with_mips * 4 values. At least one
// term.
void compose_texture(std::span<const LeafTerm> terms, int width, int height, const RadianceTable& radiance,
                     std::span<float> scratch, std::span<uint16_t> texels);

// Nearest half of a value in [0, 65504], ties to even: as half_from_float, in a form that vectorizes.
void halves_from_floats(std::span<const float> values, uint16_t* halves);

}  // namespace vitrine
