// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/device_residual.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>

#include "host/infer/coordinate_reader.h"
#include "tests/infer/test_scene.h"

namespace vitrine::testing {
namespace {

constexpr InferenceOptions kSmallPicture{.width = 64, .height = 48};
constexpr SolverOptions kExact{.regularization = 0.001f, .iterations = 200, .tolerance = 1e-5f};

// A board that runs away from the eye, partly behind a card.
std::vector<DrawnObject> make_objects() {
  DrawnObject board, card;
  board.vertices = {{-2, -1, 1, 0, 0}, {2, -1, 1, 1, 0}, {2, -1, -6, 1, 1}, {-2, -1, -6, 0, 1}};
  board.indices = {0, 1, 2, 0, 2, 3};
  card.vertices = {{-0.5f, -0.9f, 0, 0, 0}, {0.6f, -0.8f, 0, 1, 0}, {0.5f, 0.4f, -0.4f, 1, 1}};
  card.indices = {0, 1, 2};
  return {board, card};
}

constexpr TextureSize kTextureSizes[] = {{40, 56}, {8, 8}};

// Weights as an 8-bit device tells them, with row sums put right again.
ObjectMatrix rounded(ObjectMatrix matrix) {
  for (size_t s = 0; s < matrix.samples.size(); ++s) {
    float sum = 0;
    for (uint32_t e = matrix.starts[s]; e < matrix.starts[s + 1]; ++e)
      sum += matrix.entries[e].weight = std::max(1.0f, std::round(matrix.entries[e].weight * 255)) / 255;
    for (uint32_t e = matrix.starts[s]; e < matrix.starts[s + 1]; ++e) matrix.entries[e].weight /= sum;
  }
  return matrix;
}

class DeviceResidualTest : public ::testing::Test {
 protected:
  void SetUp() override {
    gpu = make_gpu();
    ASSERT_NE(gpu, nullptr);
    renderer = std::make_unique<TestRenderer>(*gpu, kSmallPicture, objects);
    const glm::mat4 clip = glm::perspective(0.9f, 4.0f / 3, 0.1f, 50.0f) *
                           glm::lookAt(glm::vec3(0.3f, 0.6f, 3), glm::vec3(0, -0.5f, 0), glm::vec3(0, 1, 0));
    state = {{clip, clip}, {0, 0}};
    const GeometryState* const states[] = {&state};
    exact = CoordinateReader(*renderer, kTextureSizes).read(states)[0][0];
    // What the device shows of two textures: there is an exact answer.
    std::vector<Texels> textures(2);
    for (size_t t = 0; t < 2; ++t)
      for (size_t i = 0; i < pyramid.finest_size(); ++i) {
        const auto x = static_cast<float>(i % 40), y = static_cast<float>(i / 40);
        textures[t].push_back(glm::vec3(0.5f) +
                              glm::vec3(0.4f, 0.3f, 0.2f) * std::sin(0.7f * x + static_cast<float>(t)) * std::cos(0.5f * y));
      }
    layers = DeviceForward(*renderer, state, pyramid, objects.size(), 0, exact.window, HeldTexel::kHalf, 1)(textures);
  }
  // Weighted errors of what the device shows: by Ax alone, and with rounds of Hx.
  std::pair<double, double> errors(const ObjectMatrix& matrix, HeldTexel held, int rounds) {
    const FilteredMatrix filtered(matrix, kSmallPicture.supersampling, kSmallPicture.width, kSmallPicture.height);
    Observation observation;
    observation.matrix = &filtered;
    observation.weight = filtered.coverage();
    for (size_t p = 0; p < observation.weight.size(); ++p) {
      float& w = observation.weight[p];
      if (w < 1.0f / 16) w = 0;
      observation.scale.push_back(w > 0 ? std::pow(w / filtered.filtered()[p], 2.0f) : 0);
      observation.rows += w > 0;
    }
    DeviceForward device(*renderer, state, pyramid, objects.size(), 0, matrix.window, held, 1);
    const ForwardOperator forward = [&](std::span<const Texels> textures) { return device(textures); };
    const auto error_of = [&](int n) {
      const auto shown = forward(solve_on_device(pyramid, observation, layers, kExact, forward, n));
      return weighted_error(observation, shown[0], layers[0]) + weighted_error(observation, shown[1], layers[1]);
    };
    return {error_of(0), error_of(rounds)};
  }

  std::vector<DrawnObject> objects = make_objects();
  Pyramid pyramid{40, 56};
  std::unique_ptr<hal::Gpu> gpu;
  std::unique_ptr<TestRenderer> renderer;
  GeometryState state;
  ObjectMatrix exact;
  std::vector<Texels> layers;
};

TEST_F(DeviceResidualTest, WhatTheTargetHoldsIsShownNoWorseThanByTheMatrixAlone) {
  for (const HeldTexel held : {HeldTexel::kHalf, HeldTexel::kByte}) {
    const auto [by_matrix, by_device] = errors(exact, held, 3);
    EXPECT_GT(by_matrix, 0);
    EXPECT_LE(by_device, by_matrix) << (held == HeldTexel::kHalf ? "halves" : "bytes");
  }
}

TEST_F(DeviceResidualTest, AnInaccurateMatrixIsMadeUpFor) {
  const double least = errors(exact, HeldTexel::kHalf, 0).first;
  const auto [by_matrix, by_device] = errors(rounded(exact), HeldTexel::kHalf, 6);
  EXPECT_GT(by_matrix, 1.05 * least) << "the matrix is as good as the exact one: nothing is tested";
  EXPECT_LT(by_device - least, 0.5 * (by_matrix - least));
}

}  // namespace
}  // namespace vitrine::testing
