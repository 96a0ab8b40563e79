// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How large the blocks of a field are and where they begin (formats/block.h), decided before anything is inferred: textures of
// one block share a map.
#pragma once

#include "formats/block.h"

namespace vitrine {

// Per axis kMaxBlockSize, or the least power of two that holds all samples. One sample along discrete axes: nothing may be
// shown that is halfway between two states of a switch.
AxisSizes block_size_of(const ParameterSpace& space);

// Origins spread over the block, so that borders of different fields do not fall together.
AxisSizes stagger_of(int field, int field_count, const ParameterSpace& space, const AxisSizes& block_size);

}  // namespace vitrine
