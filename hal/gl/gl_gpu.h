// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A Gpu over any context that has GL 3.3 core or GL ES 3.0. What differs between window systems is a GlContext.
#pragma once

#include <memory>

#include "hal/gpu.h"

namespace vitrine::hal {

using GetProc = void* (*)(const char* name);

class GlContext {
 public:
  virtual ~GlContext() = default;
  virtual bool make_current() = 0;  // on the calling thread; cheap where it is current already
  virtual GetProc loader() const = 0;
  // Of the context's framebuffer 0, in pixels, now.
  virtual void framebuffer_size(int& width, int& height) const = 0;
  // Whether framebuffer 0 is a window whose size is not the picture's: the device then draws "the context's own framebuffer"
  // into a texture of the picture's size, and present() scales it into the window with its aspect kept.
  virtual bool window() const = 0;
  virtual Status swap() = 0;
};

// `width`, `height`: of the picture.
Result<std::unique_ptr<Gpu>> create_gl_gpu(std::unique_ptr<GlContext> context, int width, int height);

}  // namespace vitrine::hal
