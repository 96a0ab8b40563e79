// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Clean references: two independent halves that grow until their difference says that the mean is good enough.
#pragma once

#include <vector>

#include "host/frames/store.h"
#include "host/trace/tracer.h"
#include "host/verify/verify.h"

namespace vitrine {

class Reference {
 public:
  // Nothing is traced yet. All arguments must outlive this.
  Reference(const Scene& scene, const Store& store, Tracer& tracer, const Position& position);
  // Doubles the number of paths (the first call traces kFirstPaths in all). Frames come from the store where they are.
  // Asks `progress` for an interruption while it traces.
  void refine(Progress& progress);

  int paths_per_pixel() const { return paths_; }
  Picture picture() const;
  // Expected mean squared error of picture(), 8-bit units: a quarter of the mean squared difference of the halves.
  double noise() const;
  // Pixels that an object covers by half or more.
  const std::vector<std::vector<int>>& pixels_of_object() const { return pixels_; }

  static constexpr int kFirstPaths = 128;

 private:
  void add(int half, int paths, uint32_t seed, Progress& progress);

  const Scene& scene_;
  const Store& store_;
  Tracer& tracer_;
  Position position_;
  StoreKey scene_key_;
  std::vector<glm::vec3> sum_[2];      // radiance times paths
  std::vector<std::vector<int>> pixels_;
  int paths_ = 0;
  uint32_t round_ = 0;
};

uint8_t srgb8_from_radiance(float radiance);

}  // namespace vitrine
