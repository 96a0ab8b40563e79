// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "host/bench/compression.h"

namespace vitrine {

// One HTML file that needs no other: tables, PSNR over bytes as a plot, and what each coder shows beside ground truth. Throws
// InputError where it cannot be written.
void write_compression_page(const std::filesystem::path& file, const CompressionReport& report);

}  // namespace vitrine
