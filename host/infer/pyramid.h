// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The MIP pyramid of one texture as one vector (all levels, finest first, rows v = 0 first) and the linear operators on it:
//   M      decimation (target/mip.h): from the finest level, which alone is unknown, to all levels; and its transpose
//   U      bilinear interpolation of a level from the next coarser one, texel centres at (x + 1/2) / w, clamped
//   Gamma  sum over levels of || x_l - U x_{l+1} ||^2, the pyramidal regularization (Hakura 2001, section 3.5.3)
// Templates are defined for float and Lanes<1>, Lanes<2>, Lanes<3>.
#pragma once

#include <cstddef>
#include <vector>

#include "target/mip.h"

namespace vitrine {

class Pyramid {
 public:
  struct Level {
    int width = 0, height = 0;
    size_t offset = 0;  // of its first texel in the vector
  };

  Pyramid() = default;
  Pyramid(int width, int height);

  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }
  const std::vector<Level>& levels() const { return levels_; }
  size_t finest_size() const { return static_cast<size_t>(width()) * static_cast<size_t>(height()); }
  size_t size() const { return size_; }  // texels of all levels

  // all[0, finest_size) is given; fills the coarser levels: all = M x.
  template <typename T>
  void decimate(T* all) const;
  // all[0, finest_size) becomes M' all; the coarser levels are spent.
  template <typename T>
  void decimate_transposed(T* all) const;
  // out += strength * 1/2 dGamma/dx_all at `all`, both over all levels (apply M' to get the gradient for the finest).
  template <typename T>
  void add_gamma_gradient(const T* all, float strength, T* out) const;
  // Interpolates level `level` from level + 1 of `all` at texel (x, y).
  template <typename T>
  T interpolate(const T* all, size_t level, int x, int y) const;

 private:
  struct Mix {  // of two neighbours in the next coarser level
    int first = 0, second = 0;
    float weight = 0;  // of the second
  };
  struct Dimension {
    std::vector<MipTaps> decimation;  // per coordinate of the next coarser level
    std::vector<Mix> interpolation;   // per coordinate of this level
  };
  static Dimension make_dimension(int size);

  std::vector<Level> levels_;
  std::vector<Dimension> columns_, rows_;  // per level but the last
  size_t size_ = 0;
};

}  // namespace vitrine
