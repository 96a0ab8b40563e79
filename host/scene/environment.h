// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Reading light probes: OpenEXR (lat-long or cube map, ImfEnvmap.h's conventions) and Radiance HDR (lat-long).
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "host/scene/scene.h"

namespace vitrine {

inline constexpr int kLargestEnvironmentWidth = 8192, kLargestEnvironmentHeight = 8192;
inline constexpr int64_t kLargestEnvironment = int64_t{8192} * 4096;  // pixels
inline constexpr float kBrightestTexel = 1e9f;

// The probe as a lat-long map; cube maps are resampled. Texels that are negative or no number become 0, infinite ones
// the brightest that is allowed; a line in `warnings` says how many. Throws InputError.
Environment read_environment(const std::filesystem::path& file, std::vector<std::string>* warnings);
Environment constant_environment(const glm::vec3& radiance);

// Lat-long coordinates of a direction in [0, 1]^2: u = 0 and u = 1 at -Z, +X at 1/4, +Z at 1/2; v = 0 at +Y.
glm::vec2 latlong_from_direction(const glm::vec3& direction);
glm::vec3 direction_from_latlong(const glm::vec2& uv);

// Radiance HDR (G. Ward, "Real Pixels", Graphics Gems II): RGBE, flat, old and new run lengths, rows top down.
Environment decode_radiance_hdr(std::span<const uint8_t> bytes);  // throws std::runtime_error with one clause
// OpenEXR, single-part: channels R, G, B, or Y alone as grey.
Environment decode_exr(std::span<const uint8_t> bytes);  // throws std::exception

}  // namespace vitrine
