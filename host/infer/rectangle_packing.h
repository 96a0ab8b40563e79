// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Places rectangles side by side in a texture.
#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "host/infer/inference.h"

namespace vitrine {

// A place for each, its low corner, none overlapping another; nothing where they are not found room. Those of no size take none.
std::optional<std::vector<glm::ivec2>> pack_rectangles(std::span<const glm::ivec2> sizes, const TextureSize& texture);

// The smallest texture that, grown by `overhang` in width and height, has room for each set by itself; its sides are multiples of
// `step`, at most `max_size`, another one. Nothing where there is none.
std::optional<TextureSize> smallest_texture(std::span<const std::vector<glm::ivec2>> sets, int overhang, int step, int max_size);

}  // namespace vitrine
