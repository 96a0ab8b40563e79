// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Files that a command will write at its end. What is wrong with their names is said before a night of work, not after it.
#pragma once

#include <filesystem>

namespace vitrine {

// Throws InputError when `file` is there but no regular file, or its folder does not exist or may not be written to.
void check_output_file(const std::filesystem::path& file);

}  // namespace vitrine
