// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace vitrine {

// Corners of the smallest convex polygon around the points, anticlockwise; fewer than three points as they are, once each.
std::vector<glm::vec2> convex_hull(std::span<const glm::vec2> points);

}  // namespace vitrine
