// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The parts of an image that are read once, when it is loaded (directory, meshes), are Zstandard frames (RFC 8878).
#pragma once

#include <cstddef>
#include <span>

#include "formats/status.h"

namespace vitrine {

// Expands one frame that holds exactly plain.size() bytes; anything else is malformed. Allocates working memory of its own.
Status expand(std::span<const std::byte> packed, std::span<std::byte> plain);

}  // namespace vitrine
