// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// An engine with its memory that plays stills: whatever is shown is decoded at once.
#pragma once

#include <cstddef>
#include <memory>

#include "formats/image.h"
#include "hal/gpu.h"
#include "host/verify/verify.h"
#include "target/engine.h"

namespace vitrine {

class StillPlayer {
 public:
  // Both must outlive it. Throws InputError where the image cannot be played.
  StillPlayer(const ImageView& image, hal::Gpu& gpu);
  // Draws into the context's own framebuffer; play() also reads it.
  void draw(const Position& position);
  Picture play(const Position& position);

 private:
  struct Free {
    void operator()(std::byte* block) const;
  };
  hal::Gpu& gpu_;
  std::unique_ptr<std::byte, Free> block_;
  std::unique_ptr<Engine> engine_;
};

}  // namespace vitrine
