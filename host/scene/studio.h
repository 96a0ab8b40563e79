// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The studio that new scenes are lit by: soft boxes around a neutral cyclorama.
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>

namespace vitrine {

// Radiance of the studio from direction `d` (unit, from the scene outwards). Smooth; the key light stands in front on the
// right. A white diffuse surface that faces the key shines with about 1.
glm::vec3 studio_radiance(const glm::vec3& d);
// Writes it as a 256 x 128 lat-long OpenEXR of half floats. Throws InputError.
void write_studio(const std::filesystem::path& file);

}  // namespace vitrine
