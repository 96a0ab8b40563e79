// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Camera samples become a Frame: per pixel plain means (samples are distributed as the pixel filter), per object cropped layers.
#pragma once

#include <vector>

#include "host/trace/frame.h"
#include "host/trace/integrator.h"

namespace vitrine::trace {

// What one object is in one pixel.
struct FilmRecord {
  int object, x, y;
  float coverage;
  glm::vec3 diffuse, specular;  // means over the object's own samples
};

// Gathers the samples of one pixel after the other; reused, so that it does not allocate per pixel.
class PixelSums {
 public:
  void clear();
  void add(const CameraSample& sample);
  // Mean radiance of all samples.
  glm::vec3 mean() const;
  void append_records(int x, int y, std::vector<FilmRecord>& records) const;

 private:
  struct Sum {
    int object, samples;
    glm::dvec3 diffuse, specular;
  };
  std::vector<Sum> sums_;  // in the order of first appearance
  glm::dvec3 total_{0};
  int samples_ = 0;
};

// Crops the records of all tiles, in their order, into one window per object that is seen, by ascending object.
std::vector<ObjectFrame> objects_from_records(const std::vector<std::vector<FilmRecord>>& tiles, int object_count);

}  // namespace vitrine::trace
