// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The rendering matrix A, read off test renderings with texel identifiers (Hakura 2001, section 3.4.3), for all objects of
// a geometry state at once (the depth buffer says which object a supersample shows).
//
// The paper shares one 8-bit picture between a weight and an identifier; a float target has room for both. One rendering
// carries identifiers in all channels: texels hold their own texture coordinates, their level and their object, so what the
// device returns is where, between which levels and on what a supersample samples. This stays unambiguous within +-2 texels
// and +-1.5 levels, also at odd sizes, where a neighbourhood of constant identifiers (paper: every 6th texel) would overlap
// the next one. So every 4th texel in u and v and every 3rd level can be set at once: 48 patterns, 4 to a rendering.
// Renderings for levels that no supersample reaches are left out: 5 to 13 renderings a state.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/infer/pyramid.h"
#include "host/infer/test_renderer.h"

namespace vitrine {

// Output pixels, row 0 at the top.
struct PixelWindow {
  int x = 0, y = 0, width = 0, height = 0;
};

struct MatrixEntry {
  uint32_t texel = 0;  // in the object's pyramid
  float weight = 0;
};

// Supersamples that show one object in one state.
struct ObjectMatrix {
  PixelWindow window;                // every output pixel whose filter reaches one of them; empty: not seen
  std::vector<uint32_t> samples;     // place in the window's grid of supersamples, row by row from the top
  std::vector<uint32_t> starts;      // entries of samples[i]: [starts[i], starts[i + 1])
  std::vector<MatrixEntry> entries;  // weights of one sample sum to 1; texels ascend
  size_t bytes() const { return samples.size() * 8 + entries.size() * sizeof(MatrixEntry); }
};
using StateMatrix = std::vector<ObjectMatrix>;  // per drawn object

class MatrixReader {
 public:
  // Texture sizes of `objects` are final. Keeps textures of all patterns while they fit into `texture_bytes`.
  MatrixReader(TestRenderer& renderer, std::span<const DrawnObject> objects, int supersampling,
               size_t texture_bytes = size_t{1} << 30);
  ~MatrixReader();
  MatrixReader(const MatrixReader&) = delete;
  MatrixReader& operator=(const MatrixReader&) = delete;

  // Throws InputError where the device mixes more than kMaxTaps texels or weights do not sum to 1 within 1e-4.
  std::vector<StateMatrix> read(std::span<const GeometryState* const> states);

  static constexpr int kMaxTaps = 8;

 private:
  struct Scratch;
  const std::vector<hal::Texture>& pattern_textures(int rendering);
  void release_pattern(int rendering);
  void render_identifiers(const GeometryState& state, Scratch& scratch);
  void collect(int rendering, Scratch& scratch) const;
  StateMatrix assemble(const Scratch& scratch) const;

  TestRenderer* renderer_;
  int supersampling_;
  bool keep_patterns_;
  std::vector<Pyramid> pyramids_;
  std::vector<hal::Texture> identifiers_;
  std::vector<std::vector<hal::Texture>> patterns_;
  std::vector<Scratch> scratch_;  // kept from one read to the next
};

// The identifiers of one texture: (u, v, level, object + 1) per texel of the pyramid.
std::vector<glm::vec4> identifier_texels(const Pyramid& pyramid, int object);

}  // namespace vitrine
