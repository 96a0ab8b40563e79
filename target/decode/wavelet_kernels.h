// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The inverse wavelet, line by line, in vectors of whatever this machine has. The steps are those of formats/wavelet.h.
#pragma once

#include <cstdint>

namespace vitrine {

// The four rows that a step of the wavelet reads: a and b next to what it makes, c and d beyond them.
struct WaveletRows {
  const int16_t *a, *b, *c, *d;
};
// out[x] = low[x] - update, for even rows.
void invert_update_row(const int16_t* low, const WaveletRows& details, int width, int16_t* out);
// out[x] = high[x] + prediction, for odd rows.
void invert_predict_row(const int16_t* high, const WaveletRows& evens, int width, int16_t* out);
// A line of low and high samples, one after the other, to a line of `width` samples. Lines may not overlap. Not `detailed`:
// the high samples are zero, and not read.
void invert_line(const int16_t* line, int width, bool detailed, int16_t* out);
// Samples to texels, in place: without fraction, clamped to what a node can hold.
void texels_from_samples(int16_t* row, int width);

}  // namespace vitrine
