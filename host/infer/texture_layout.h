// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How large the textures of every field are, and how they lie on its object's mesh: one map per block, for what the block's own
// samples and those next to them show. Neighbours count since, between samples, the nearest texture is shown on exact geometry.
#pragma once

#include <span>
#include <vector>

#include "host/infer/fields.h"
#include "host/infer/inference.h"
#include "host/infer/texture_coordinates.h"
#include "host/infer/visible_surface.h"

namespace vitrine {

struct LayoutOptions {
  TextureFitOptions fit;
  int max_size = 1024;
  TextureLayout layout = TextureLayout::kFitted;
  bool one_map = false;  // for all blocks: where samples of different blocks are blended
};

// Fills a field's texture size, maps and block_maps. `surfaces`: per state, of the field's object; `patches`: of its domain,
// along which its mesh is cut. Sizes are multiples of 8 in [8, max_size], the same for all blocks: what the largest needs.
void lay_out(const StateTable& states, const ParameterSpace& space, std::span<const VisibleSurface* const> surfaces,
             std::span<const DomainPart> patches, const LayoutOptions& options, Field& field);

// Where to cut the domain of an object with these fields, for what a few blocks of each show.
std::vector<DomainPart> patches_for(const StateTable& states, const ParameterSpace& space,
                                    std::span<const VisibleSurface* const> surfaces, const LayoutOptions& options,
                                    std::span<const Field* const> fields);

// The states that a block's textures may be shown in, ascending; per block.
std::vector<std::vector<int>> states_of_blocks(const StateTable& states, const ParameterSpace& space, const Field& field);

}  // namespace vitrine
