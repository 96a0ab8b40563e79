// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Reading files and the URIs by which a glTF names its companions (glTF 2.0, section 2.8).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace vitrine {

using Bytes = std::vector<uint8_t>;

// `path` as it stands in messages.
std::string shown(const std::filesystem::path& path);

// The whole of a regular file. Throws InputError where it is missing, unreadable or larger than `largest` bytes.
Bytes read_file(const std::filesystem::path& path, uint64_t largest);
// Writes a whole file. Throws InputError.
void write_file(const std::filesystem::path& path, const void* data, size_t size);

bool is_data_uri(const std::string& uri);
// Payload of a base64 data: URI (RFC 2397). Throws std::runtime_error with one clause.
Bytes decode_data_uri(const std::string& uri);
// The file that a relative URI names, `folder` being that of the glTF. Percent-encoding is undone. Throws
// std::runtime_error with one clause for schemes, absolute paths and whatever would leave `root`.
std::filesystem::path file_of_uri(const std::string& uri, const std::filesystem::path& folder, const std::filesystem::path& root);

}  // namespace vitrine
