// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A look at an OpenEXR header before the library sees it ("OpenEXR File Layout", openexr.com). The library sizes its
// buffers by what a header says, while it opens the file and before a caller can object: a hundred bytes cost gigabytes.
#pragma once

#include <cstdint>
#include <span>

namespace vitrine {

// Throws std::runtime_error with one clause unless the file is single-part, not deep, of a size that is read here, and its
// attributes and tiles fit into the bytes that there are.
void check_exr_header(std::span<const uint8_t> file);

}  // namespace vitrine
