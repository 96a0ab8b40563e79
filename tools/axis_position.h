// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Positions on the command line: "view=0.5,lamp=#2".
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "formats/parameter_space.h"

namespace vitrine {

// What is wrong with the text and what to write instead, on one line.
struct PositionError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// AXIS=POSITION in [0, 1] or AXIS=#SAMPLE, separated by commas; axes that are not named stay at 0. `names`: the space's axes.
// Throws PositionError.
Position parse_position(const std::string& text, const std::vector<std::string>& names, const ParameterSpace& space);

}  // namespace vitrine
