// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What every backend demands of a description before it does anything with it. Pure functions; the checks that need the
// device's own objects (does this handle live, is this rectangle inside that level) are CheckedGpu's.
#pragma once

#include "hal/gpu.h"

namespace vitrine::hal {

inline constexpr int kMaxSamplers = 8, kMaxUniforms = 192, kMaxAttributes = 16;
inline constexpr int kMaxStride = 255;  // bytes; WebGL 2 allows no more

int level_count_of(int width, int height);  // of a full chain down to 1 x 1
int level_size(int size, int level);        // max(1, floor(size / 2^level))

Status check_texture(const TextureDesc& desc, int max_texture_size);
Status check_mesh(const MeshDesc& desc);
Status check_program(const ProgramDesc& desc);
Status check_target(const TargetDesc& desc, const DeviceInfo& device);

}  // namespace vitrine::hal
