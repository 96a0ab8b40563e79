// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The rendering matrix by texel identifiers (Hakura 2001, section 3.4.3).
//
// The paper shares one 8-bit picture between a weight and an identifier; a float target has room for both. One rendering
// carries identifiers in all channels: texels hold their own texture coordinates, their level and their object, so what the
// device returns is where, between which levels and on what a tap samples. This stays unambiguous within +-2 texels
// and +-1.5 levels, also at odd sizes, where a neighbourhood of constant identifiers (paper: every 6th texel) would overlap
// the next one. So every 4th texel in u and v and every 3rd level can be set at once: 48 patterns, 4 to a rendering.
// Renderings for levels that no supersample reaches are left out: 5 to 13 renderings a state and tap.
#pragma once

#include "host/infer/rendering_matrix.h"

namespace vitrine {

class IdentifierReader final : public MatrixReader {
 public:
  // `sizes`: of the texture that each object is drawn with. Keeps textures of all patterns while they fit into `texture_bytes`.
  IdentifierReader(TestRenderer& renderer, std::span<const TextureSize> sizes, size_t texture_bytes = size_t{1} << 30);
  ~IdentifierReader() override;
  IdentifierReader(const IdentifierReader&) = delete;
  IdentifierReader& operator=(const IdentifierReader&) = delete;

  std::vector<StateMatrix> read(std::span<const GeometryState* const> states) override;
  int64_t renderings() const override { return renderings_; }
  const char* method() const override { return "identifiers"; }

 private:
  struct Tap;
  const std::vector<hal::Texture>& pattern_textures(int rendering);
  void release_pattern(int rendering);
  void render_identifiers(const GeometryState& state, int number, Tap& tap);
  void collect(int rendering, Tap& tap) const;
  StateMatrix assemble(std::span<const Tap> taps) const;

  TestRenderer* renderer_;
  bool keep_patterns_;
  int64_t renderings_ = 0;
  std::vector<Pyramid> pyramids_;
  std::vector<hal::Texture> identifiers_;
  std::vector<std::vector<hal::Texture>> patterns_;
  std::vector<std::vector<Tap>> taps_;  // per state; kept from one read to the next
};

// The identifiers of one texture: (u, v, level, object + 1) per texel of the pyramid.
std::vector<glm::vec4> identifier_texels(const Pyramid& pyramid, int object);
// The textures of all objects. Throws InputError where the device refuses.
std::vector<hal::Texture> create_identifier_textures(TestRenderer& renderer, std::span<const Pyramid> pyramids);

}  // namespace vitrine
