// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The rendering matrix on a device without float targets: by texel identifiers in 8 bits (Hakura 2001, section 3.4.3).
//
// A pattern is a set of texels that are solved at once. One rendering has their alpha at full intensity and in red, green and
// blue of all texels that a sample can mix with one of them its number (24 bits), which so arrives whole. Every third level is
// solved at once and in it every sixth or seventh texel each way (filter_neighbourhood.h): 3 x 6 x 6 = 108 patterns at sizes that
// halve evenly, up to 3 x 7 x 7 at others, and 3 x 8 x 8 where a texture of powers of two repeats. Patterns of levels that no
// supersample reaches are left out.
//
// The paper offers two remedies for what 8 bits cut off, and one alone is not enough for A x to be within 2/255 of a rendering,
// which itself is rounded at each stage of the device's filter (measured on OSMesa: 2.3/255). So both are taken: a weight is the
// slope of the least-squares line through five intensities, of which a second rendering of a pattern brings four at once, as it
// needs no numbers any more; and what a row then lacks of 1 is shared among its entries. Weights below half a step vanish.
// Devices filter bytes with coarser fractions than floats, so what is read is theirs, not what floats would give.
// infer_textures itself still surveys surfaces in floats, and so refuses such a device.
#pragma once

#include "host/infer/filter_neighbourhood.h"
#include "host/infer/rendering_matrix.h"

namespace vitrine {

class TapRows;

class EightBitReader final : public MatrixReader {
 public:
  // `renderer` draws kRgba8 pictures. `sizes`: of the texture that each object is drawn with; `wraps`: of each, or empty: none
  // repeats. Throws InputError where a texture has more texels than 24 bits tell apart.
  EightBitReader(TestRenderer& renderer, std::span<const TextureSize> sizes, std::span<const TextureWraps> wraps = {});
  ~EightBitReader() override;
  EightBitReader(const EightBitReader&) = delete;
  EightBitReader& operator=(const EightBitReader&) = delete;

  std::vector<StateMatrix> read(std::span<const GeometryState* const> states) override;
  int64_t renderings() const override { return renderings_; }
  const char* method() const override { return "eight_bit"; }

 private:
  struct Texel8 {
    uint8_t red = 0, green = 0, blue = 0, alpha = 0;
  };
  struct Solved {  // how a level is solved: every spacing-th texel, in columns * rows renderings
    int columns = 1, rows = 1;
  };
  struct Texture {
    Pyramid pyramid;
    TextureWraps wraps;
    std::vector<Solved> solved;         // per level
    hal::Texture number;                // the object's own in all texels
    hal::Texture residues;              // which residue a level's number leaves: in red, green or blue
    hal::Texture pattern, intensities;  // what a pattern's two renderings show
  };
  struct Tap;
  struct State;

  Texture make_texture(const Pyramid& pyramid, const TextureWraps& wraps, size_t number);
  std::vector<hal::Texture> textures_of(hal::Texture Texture::*member) const;
  template <typename Body>
  void for_each_solved(const Texture& texture, int residue, int pattern, const Body& body) const;
  void fill_neighbourhood(const Texture& texture, size_t level, int x, int y, std::vector<Texel8>& texels) const;
  void update_patterns(int residue, int pattern);
  void render(const GeometryState& state, std::span<const hal::Texture> textures, int tap, std::vector<glm::vec4>& picture);
  void survey(const GeometryState& geometry, State& state);
  int pattern_count(int residue, const Tap& tap) const;
  void read_pattern(std::span<const GeometryState* const> states, int residue, int pattern);
  void collect(const State& state, Tap& tap) const;

  TestRenderer* renderer_;
  int64_t renderings_ = 0;
  std::vector<Texture> textures_;
  std::vector<State> states_;                     // kept from one read to the next
  std::vector<glm::vec4> picture_, intensities_;  // the latest renderings
};

}  // namespace vitrine
