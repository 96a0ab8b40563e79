// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The least-squares solution (Hakura 2001, section 3.5) for textures that share their matrices: up to kMaxTextures textures
// at once, over one geometry state (layers that depend on the view) or many (layers that do not, section 3.5.2).
//
//   min  sum over states, pixels of  scale (F A M x - c b)^2  +  mu (Gamma(x) + kHold |x - x0|^2),    scale = share (W / c)^2,
//
// with c the filtered coverage F A 1: the equation of each row is divided by c, which gives share W^2 (F A M x / c - b)^2; and x0
// a push-pull filling of the pixels' light, from which the search starts. It is minimized by conjugate gradients on the normal
// equations, preconditioned by the row sums of the data term. Channels run in lock step but with steps of their own, and one that
// has converged stands still, so that a texture comes out the same whichever others are solved beside it. Range regularization is
// minimized from there on by Newton's method, whose steps conjugate gradients find.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "host/infer/data_term.h"
#include "host/infer/pyramid.h"

namespace vitrine {

struct SolverOptions {
  float regularization = 0.3f;  // e_f
  int iterations = 40;
  float tolerance = 1e-3f;  // of the preconditioned gradient, relative to that at x = 0
  // e_b of the range regularization (range_penalty.h). The chapter finds it not needed beside the pyramidal one.
  float range_regularization = 0;
  float white = 1;  // radiance that the display shows as white: the end of the range
};

class TextureSolver {
 public:
  static constexpr size_t kMaxTextures = 4;

  // Keeps references. `count` textures, 1..kMaxTextures.
  TextureSolver(const Pyramid& pyramid, size_t count, const SolverOptions& options);
  ~TextureSolver();
  TextureSolver(TextureSolver&&) noexcept;

  // Adds a state's right side: layers[i][p] is b of texture i at pixel p of the window. Order matters for the last bits.
  void add(const Observation& observation, std::span<const std::vector<glm::vec3>> layers);
  // [texture][texel of the finest level], clamped to >= 0. `data`: of all states that were added. Once only: right sides are
  // spent.
  std::vector<std::vector<glm::vec3>> solve(const DataTerm& data);
  // How much the pixels say of each texel of the finest level: its row of the data term's normal equations, summed; pixels.
  // After solve().
  const std::vector<float>& precision() const;
  size_t bytes() const;

 private:
  struct Base;
  template <int K>
  struct Impl;
  std::unique_ptr<Base> impl_;
};

// out += M' A' F' (W / c): how many screen pixels each texel of the finest level feeds. `out`: the whole pyramid is needed
// as working space, pass finest-level results through Pyramid::decimate_transposed when all states are added.
void add_importance(const Observation& observation, float factor, std::vector<float>& all_levels);

}  // namespace vitrine
