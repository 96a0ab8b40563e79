// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Which texels a sample can mix with a given one, and how far apart texels must stand so that no sample mixes two of them or
// what can be mixed with either (Hakura 2001, section 3.4.3: T0 and T1(T0), figure 3.5). The paper's textures have powers of
// two texels each way and so every sixth is far enough, or every eighth where the texture repeats. Ours have any size, and an
// odd level of n texels lies on one of floor(n / 2): there neighbourhoods drift, so they are worked out texel by texel, one
// dimension at a time, and the spacing is what they leave.
#pragma once

#include <vector>

#include "hal/gpu.h"

namespace vitrine {

// Texels [first, last] of one dimension. Where it repeats: modulo its size; [first, last] can be longer than that.
struct TexelRange {
  int first = 0, last = 0;
};

// Along a dimension that has `from` texels at one level: all texels of a level with `to` texels, which is the same one, the next
// finer or the next coarser, that a sample can mix if it gives texel `texel` of the first any weight. Devices round where they
// sample to fractions of a texel, a sixteenth at the coarsest; that much the range allows for.
TexelRange filter_neighbourhood(int texel, int from, int to, bool same_level, hal::TextureWrap wrap);

// The smallest spacing at which texels of level `level` can be solved in parallel: no neighbourhood of one meets that of another
// at this level, the next finer or the next coarser. `sizes`: of the dimension at all levels, finest first.
int safe_spacing(const std::vector<int>& sizes, int level, hal::TextureWrap wrap);

}  // namespace vitrine
