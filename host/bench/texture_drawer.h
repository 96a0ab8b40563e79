// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Pictures drawn with textures of one's own by the target's drawing code: inferred ones, or what a coder made of them.
#pragma once

#include <functional>
#include <memory>

#include "host/infer/inference.h"
#include "host/infer/verification.h"
#include "host/verify/verify.h"

namespace vitrine {

class TextureDrawer {
 public:
  // References are kept. Throws InputError where there is no device.
  TextureDrawer(const Scene& scene, const Inference& inference, const InferenceOptions& options);

  // The texture of a field (its number) at a sample of its own space (flat).
  using Textures = std::function<LinearTexture(size_t field, int64_t sample)>;
  // The picture at a grid sample as a display shows it.
  Picture draw(int64_t sample, const Textures& textures);

 private:
  const Scene& scene_;
  const Inference& inference_;
  InferenceOptions options_;
  std::unique_ptr<hal::Gpu> gpu_;
  std::unique_ptr<TestRenderer> renderer_;
};

}  // namespace vitrine
