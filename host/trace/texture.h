// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Texture fetches with glTF's wrap modes and KHR_texture_transform: bilinear (nearest where the sampler says so), unfiltered in
// scale, since many camera samples fall into a pixel.
#pragma once

#include <array>

#include "host/scene/scene.h"

namespace vitrine::trace {

using TexCoords = std::array<glm::vec2, 2>;

// RGBA as stored, in [0, 1]. `reference.image` must be valid.
glm::vec4 fetch_linear(const Scene& scene, const TextureRef& reference, const TexCoords& uv);
// The same with RGB decoded from sRGB before filtering.
glm::vec4 fetch_srgb(const Scene& scene, const TextureRef& reference, const TexCoords& uv);

}  // namespace vitrine::trace
