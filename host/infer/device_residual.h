// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Solving with Hx (Hakura 2001, section 3.5.1, equation 3.6): what counts is what the device shows of the texture as the target
// will hold it, not what the matrix says of it. The gradient 2 A'(H x - b) vanishes where x solves  min || A x - b' ||^2  with
// b' = b + (A x - H x): so right sides are corrected by what the matrix had wrong about the last solution, and solved again.
// `vitrine compile` does without: on devices with float targets the matrix is exact to a millionth.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "host/infer/solver.h"
#include "host/infer/test_renderer.h"

namespace vitrine {

using Texels = std::vector<glm::vec3>;  // of the finest level, linear radiance

// What is shown, per pixel of the observation's window, of each of several textures: divided by the object's filtered coverage.
using ForwardOperator = std::function<std::vector<Texels>(std::span<const Texels> textures)>;

enum class HeldTexel { kHalf, kByte };  // RGBA16F; RGBA8, linear, in parts of display white

// H: draws one object of a state, hidden by all others, with each texture quantized as it will be held. Keeps references.
class DeviceForward {
 public:
  // `object`: its number among those of the renderer. `white`: radiance of the largest byte.
  DeviceForward(TestRenderer& renderer, const GeometryState& state, const Pyramid& pyramid, size_t object_count, size_t object,
                const PixelWindow& window, HeldTexel held, float white);
  ~DeviceForward();
  DeviceForward(const DeviceForward&) = delete;
  DeviceForward& operator=(const DeviceForward&) = delete;
  std::vector<Texels> operator()(std::span<const Texels> textures);

 private:
  hal::Texture upload(const Texels& texels) const;
  Texels show(const Texels& texels);

  TestRenderer& renderer_;
  const GeometryState& state_;
  const Pyramid& pyramid_;
  size_t object_;
  PixelWindow window_;
  HeldTexel held_;
  float white_;
  std::vector<hal::Texture> textures_;
};

// The least-squares textures by Ax, then at most `rounds` times corrected by what `forward` shows, while that lessens
// ||W(Hx - b)||: of each texture the best. `layers`: b of each texture over the window.
std::vector<Texels> solve_on_device(const Pyramid& pyramid, const Observation& observation, std::span<const Texels> layers,
                                    const SolverOptions& options, const ForwardOperator& forward, int rounds);

// ||W (shown - b)||^2 over the rows of an observation.
double weighted_error(const Observation& observation, const Texels& shown, const Texels& layer);

}  // namespace vitrine
