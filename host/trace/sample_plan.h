// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// How many samples each pixel is given: as many as bring the noise of every object's layers to a target, shared out so that
// they are fewest. Noise counts as it will be seen: in the codes of an sRGB display, and in layers that do not depend on the
// view after the average over all views that inference will make.
//
// A layer whose samples have the variance V in a pixel has the error V / n there after n of them. The fewest samples for a
// given mean error over the layer's pixels are n = k sqrt(V) (Neyman 1934). V is the mean of what the samples of a pixel's
// neighbours tell, never its own: the count of a pixel that followed its own samples would bias their mean (Kirk & Arvo 1991).
// Nor do its own samples choose the object: a pixel meets the needs of all objects that its eight neighbours show most of, and
// is at an edge where these show several. k is the object's without the pixels that it told V; whether a pixel is at an edge
// is settled once, when all have the same number of samples. What no neighbour found leaves noise, and no bias. What stays of
// a pixel's influence on itself goes by way of its neighbours' counts, which change how well they tell V, not what V is in
// the mean.
#pragma once

#include <array>
#include <vector>

#include "host/trace/film.h"

namespace vitrine::trace {

struct NoiseTarget {
  double error = 0;              // root mean square per object and layer, sRGB codes in [0, 1]; 0: budgets stay as they are
  std::vector<float> views;      // per object, over which its layers that do not depend on the view are averaged
  double max_mean_samples = 64;  // camera samples of a pixel in the mean; where the target needs more, it is missed evenly
  float white = 1;               // radiance that the display shows as white
};

struct PixelBudget {
  int samples = 0, diffuse = 0, specular = 0;  // camera samples in all; those of each object that give these layers
};

// Of one object's two layers, in the units of NoiseTarget: what the samples so far have left. 0 where it is not seen.
using LayerNoise = std::array<double, 2>;

class SamplePlan {
 public:
  // The same for all pixels.
  SamplePlan(int width, int height, int samples);
  // From what is on the film: budgets that reach the target, never fewer than the film has.
  void revise(const Film& film, const NoiseTarget& target, int object_count);

  const PixelBudget& at(int x, int y) const {
    return budgets_[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)];
  }
  int most_samples() const;  // of any pixel
  // Per object, as estimated by the last revise().
  const std::vector<LayerNoise>& noise() const { return noise_; }

 private:
  int width_, height_;
  std::vector<PixelBudget> budgets_;
  // Where several objects meet, as the first revise() saw it, when all pixels had the same number of samples: with more
  // samples a pixel finds more, and those that it told would tell it in turn.
  std::vector<char> edges_;
  std::vector<LayerNoise> noise_;
};

}  // namespace vitrine::trace
