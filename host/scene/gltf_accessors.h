// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Accessors (glTF 2.0, section 3.6): typed views of buffers. A view is checked whole when it is opened; reading an element
// then touches no byte outside of it. Elements are read on demand, so a large accessor that many primitives share costs
// nothing by itself.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <vector>

#include "host/scene/gltf_document.h"

namespace vitrine {

inline constexpr int kMostElements = 60'000'000;  // of one accessor

class Accessor {
 public:
  size_t size() const { return count_; }
  int components() const { return components_; }
  // Component `c` of element `i` as a real number: normalized integers as glTF 2.0, section 3.6.2.2 says. Never NaN or
  // infinite (fails instead).
  float value(size_t i, int c) const;
  // The same as an unsigned integer; for accessors opened with open_indices or open_joints.
  uint32_t integer(size_t i, int c) const;
  glm::vec2 vec2(size_t i) const { return {value(i, 0), value(i, 1)}; }
  glm::vec3 vec3(size_t i) const { return {value(i, 0), value(i, 1), value(i, 2)}; }
  glm::vec4 vec4(size_t i) const { return {value(i, 0), value(i, 1), value(i, 2), components_ > 3 ? value(i, 3) : 1.0f}; }

 private:
  friend Accessor open_accessor(GltfDocument&, const JsonView&, int, int);
  friend class AccessorOpener;
  explicit Accessor(JsonView place) : place_(std::move(place)) {}

  JsonView place_;
  const uint8_t* data_ = nullptr;
  size_t stride_ = 0, count_ = 0;
  int components_ = 1, type_ = 0;
  bool normalized_ = false;
  std::shared_ptr<const Bytes> owned_;
};

// The accessor whose index `reference` holds, with `least` to `most` components (SCALAR 1, VEC2 2, VEC3 3, VEC4 4, MAT4 16).
Accessor open_accessor(GltfDocument& document, const JsonView& reference, int least, int most);
// Vertex indices: scalars of an unsigned type.
Accessor open_indices(GltfDocument& document, const JsonView& reference);
// Four unsigned bytes or shorts.
Accessor open_joints(GltfDocument& document, const JsonView& reference);
// All values of an accessor with exactly `components`, one element after another.
std::vector<float> read_floats(GltfDocument& document, const JsonView& reference, int components);

}  // namespace vitrine
