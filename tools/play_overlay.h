// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A few lines of figures in the picture's upper left corner.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "hal/gpu.h"

namespace vitrine {

class Overlay {
 public:
  static Result<std::unique_ptr<Overlay>> create(hal::Gpu& gpu);
  // Draws over what is on the screen. Allocates nothing. `text`: lines of printable ASCII.
  Status draw(const char* text);

 private:
  explicit Overlay(hal::Gpu& gpu) : gpu_(&gpu) {}
  Status create_objects();
  void fill(float left, float top, float right, float bottom);

  static constexpr int kWidth = 256, kHeight = 64;
  hal::Gpu* gpu_;
  hal::Texture texture_;
  hal::Program program_;
  hal::Mesh mesh_;
  std::vector<uint8_t> texels_ = std::vector<uint8_t>(4 * kWidth * kHeight);
};

}  // namespace vitrine
