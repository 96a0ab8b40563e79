// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <unordered_map>
#include <vector>

#include "formats/mesh.h"

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
  struct Hash {
    size_t operator()(const std::array<uint32_t, 5>& key) const {
      uint64_t h = 0x9e3779b97f4a7c15ull;
      for (const uint32_t k : key) h = (h ^ k) * 0xff51afd7ed558ccdull, h ^= h >> 32;
      return static_cast<size_t>(h);
    }
  };
  std::unordered_map<std::array<uint32_t, 5>, uint32_t, Hash> numbers_;
};

}  // namespace vitrine
