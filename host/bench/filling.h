// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Two ways to fill the undefined parts of a picture from the defined ones. Both leave a picture without any as it is.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace vitrine {

// width x height values, row by row; those with defined[i] = 0 mean nothing.
struct PartialPicture {
  int width = 0, height = 0;
  std::vector<glm::vec3> values;
  std::vector<uint8_t> defined;
};

// Boundary reflection: the value as far behind the nearest defined pixel as the undefined one lies before it, or that pixel's own
// where nothing is defined there.
std::vector<glm::vec3> fill_by_reflection(const PartialPicture& picture);

// Push-pull (Gortler et al., "The Lumigraph", 1996): means of what is defined, coarser and coarser, interpolated back.
std::vector<glm::vec3> fill_from_neighbors(const PartialPicture& picture);

}  // namespace vitrine
