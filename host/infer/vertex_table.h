// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <unordered_map>
#include <vector>

#include "formats/mesh.h"
#include "host/infer/bit_hash.h"

namespace vitrine {

// Vertices by position and texture coordinates, in order of their first use.
class VertexTable {
 public:
  uint32_t index_of(const MeshVertex& vertex, std::vector<MeshVertex>& vertices) {
    std::array<uint32_t, 5> key;
    std::memcpy(key.data(), &vertex, sizeof key);
    const auto [at, is_new] = numbers_.emplace(key, static_cast<uint32_t>(vertices.size()));
    if (is_new) vertices.push_back(vertex);
    return at->second;
  }

 private:
  std::unordered_map<std::array<uint32_t, 5>, uint32_t, BitHash> numbers_;
};

}  // namespace vitrine
