// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hal/gl/gl_functions.h"
#include "hal/gpu.h"

namespace vitrine::hal {

// Compiles and links; samplers are bound to units 0, 1, ... in their order. The driver's log goes to stderr where it fails.
// `es`: the context is GL ES, so the bodies get its #version line.
Result<GLuint> build_gl_program(const GlFunctions& gl, const ProgramDesc& desc, bool es);

}  // namespace vitrine::hal
