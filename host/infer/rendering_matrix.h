// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The rendering matrix A (Hakura 2001, section 3.4): which texels the device mixes, and how, where a supersample shows an object.
// It is read off test renderings of all objects of a geometry state at once (the depth buffer says which object a supersample
// shows), in one of four ways:
//   by coordinates     one rendering a tap and the formula of GL's filters, where a device is seen to follow it
//   by identifiers     of texels, which trusts no formula, in floats (identifier_reader.h) or in 8 bits (eight_bit_reader.h)
//   by bounding boxes  of blocks of texels, slow, which knows nothing of filters and checks the others (bounding_box_reader.h)
#pragma once

#include <cstdint>
#include <memory>
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
  virtual ~MatrixReader() = default;
  // Throws InputError where the device mixes more texels than its filter says or weights do not sum to 1 within 1e-4.
  virtual std::vector<StateMatrix> read(std::span<const GeometryState* const> states) = 0;
  virtual int64_t renderings() const = 0;  // so far
  virtual const char* method() const = 0;  // "identifiers", "coordinates", "eight_bit", "bounding_boxes"
};

// The largest difference of two weights of the same texel and sample; infinite where samples or objects differ.
float largest_difference(const StateMatrix& a, const StateMatrix& b);

enum class MatrixMethod : uint8_t { kIdentifiers, kCoordinates, kEightBit };

// The fastest that is right on this device: 8-bit where `renderer` draws 8-bit pictures, else by coordinates where they give what
// identifiers give in `state`. `sizes`: of the texture that each object is drawn with.
MatrixMethod choose_matrix_method(TestRenderer& renderer, std::span<const TextureSize> sizes, const GeometryState& state);
std::unique_ptr<MatrixReader> make_matrix_reader(MatrixMethod method, TestRenderer& renderer, std::span<const TextureSize> sizes);

}  // namespace vitrine
