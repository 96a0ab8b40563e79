// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Ways through a block of samples that video coders can follow (Hakura 2001, figure 4.7): from sample to neighbouring sample.
#pragma once

#include <cstdint>
#include <vector>

#include "formats/block.h"

namespace vitrine {

// The samples of a box, flat, back and forth along `fastest`, then along the other axes from the last to the first.
std::vector<int64_t> zig_zag(const ParameterSpace& space, const FieldShape::Box& box, int fastest);

// Axes along which a box has more than one sample; the first where it has one alone: what `fastest` may be.
std::vector<int> path_axes(const ParameterSpace& space, const FieldShape::Box& box);

}  // namespace vitrine
