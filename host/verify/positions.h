// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Where an image is verified.
#pragma once

#include <vector>

#include "formats/parameter_space.h"

namespace vitrine {

// `count` grid samples, spread over the whole grid (golden-ratio steps along every axis).
std::vector<Position> positions_at(const ParameterSpace& space, int count);
// As above, but half a sample on along one axis, the axes in turn (discrete axes stay on their values).
std::vector<Position> positions_between(const ParameterSpace& space, int count);
// As above, but off the samples along every axis, by fractions that are not halves.
std::vector<Position> positions_off(const ParameterSpace& space, int count);

}  // namespace vitrine
