// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The rendering matrix by blocks of texels whose projections do not overlap (Hakura 2001, section 3.4.2): slow, and a check on
// the other readers, as it knows nothing of how a device filters.
//
// First, blocks are halved both ways from whole levels down to the block size of equation 3.3, all texels of a block set at
// once: where a rendering is not black, its bounding box on the screen lies, and a block without one is done with. Then blocks
// whose boxes do not overlap are solved together, texel by texel of a block. Four channels carry four blocks, or texels, at once.
// All objects are drawn in all renderings, so the depth buffer is the scene's; boxes of different objects may overlap, as it is
// known which object a supersample shows. Blocks also stay apart while they are halved (the paper halves one at a time).
#pragma once

#include <cstdint>
#include <functional>

#include "host/infer/rendering_matrix.h"

namespace vitrine {

class TapRows;

class BoundingBoxReader final : public MatrixReader {
 public:
  // `renderer` draws kRgba32f pictures. `sizes`: of the texture that each object is drawn with; `wraps`: of each, or empty: none
  // repeats.
  BoundingBoxReader(TestRenderer& renderer, std::span<const TextureSize> sizes, std::span<const TextureWraps> wraps = {});
  ~BoundingBoxReader() override;
  BoundingBoxReader(const BoundingBoxReader&) = delete;
  BoundingBoxReader& operator=(const BoundingBoxReader&) = delete;

  std::vector<StateMatrix> read(std::span<const GeometryState* const> states) override;
  int64_t renderings() const override { return renderings_; }
  const char* method() const override { return "bounding_boxes"; }

 private:
  // Of supersamples, as pictures are read back.
  struct Box {
    int left = INT32_MAX, bottom = INT32_MAX, right = -1, top = -1;
    bool empty() const { return right < 0; }
    bool overlaps(const Box& other) const {
      return left <= other.right && other.left <= right && bottom <= other.top && other.bottom <= top;
    }
    void include(int x, int y);
  };
  struct Block {
    size_t object = 0, level = 0;
    int x = 0, y = 0, width = 0, height = 0;  // texels
    Box box;
  };
  // Up to four blocks of one object that are set in a rendering, a channel each, within a box that is known already.
  struct Family {
    Box box;
    std::vector<Block> blocks;
  };
  using Texels = std::function<glm::vec4(int x, int y)>;  // counted from the block's corner

  StateMatrix read_state(const GeometryState& state);
  void read_tap(const GeometryState& state, int tap, TapRows& rows);
  std::vector<Block> visible_blocks(const GeometryState& state, int tap);
  std::vector<Block> measure(const GeometryState& state, int tap, std::vector<Family> families);
  void solve(const GeometryState& state, int tap, std::span<const Block* const> blocks, TapRows& rows);
  std::vector<Family> whole_levels() const;
  void fill(const Block& block, const Texels& texels);
  void render(const GeometryState& state, int tap);
  template <typename Item>
  void own_boxes(std::span<const Item* const> items);
  template <typename Body>
  void for_each_owned(const Body& body) const;

  TestRenderer* renderer_;
  int64_t renderings_ = 0;
  std::vector<Pyramid> pyramids_;
  std::vector<hal::Texture> textures_, numbers_;
  std::vector<glm::vec4> identifiers_, picture_;  // objects alone; the latest rendering
  std::vector<int32_t> owners_;                   // per supersample: whose box it lies in, among those solved together; or -1
};

}  // namespace vitrine
