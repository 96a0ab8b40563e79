// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Files that are whole or absent. Content is followed by a seal of 24 bytes: "VITRSEAL", the content's size and its XXH3 hash
// (both 64 bit, little-endian). Readers of the content's own format ignore what follows it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace vitrine {

// Writes to a fresh file in `scratch` (same file system), syncs it and renames it to `path`, making parent folders. Throws
// InputError where the disk refuses. Two writers of one path leave one of the two files.
void write_sealed(const std::filesystem::path& path, const std::filesystem::path& scratch, std::string content);

// The content, or nothing where the file is missing, cut short or altered.
std::optional<std::string> read_sealed(const std::filesystem::path& path);

// Whether a file with a seal of the right size is there; does not read the content.
bool has_sealed(const std::filesystem::path& path);

// Deletes what writers that were killed more than a day ago left in `scratch`.
void clean_scratch(const std::filesystem::path& scratch);

}  // namespace vitrine
