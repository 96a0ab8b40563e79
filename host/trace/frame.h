// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What the tracer makes of one grid sample.
#pragma once

#include <algorithm>
#include <cstddef>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace vitrine {

// One object's light in one frame, cropped to the pixels that it covers. Row 0 is the top of the picture.
struct ObjectFrame {
  int object = 0;                           // index into Scene::objects
  int x = 0, y = 0, width = 0, height = 0;  // data window; 0 x 0 where the object is not seen
  std::vector<float> coverage;              // filtered with the pixel filter, [0, 1]
  // Radiance divided by coverage; 0 where coverage is 0.
  std::vector<glm::vec3> diffuse;   // what first hits scatter diffusely, and emit; the same from everywhere
  std::vector<glm::vec3> specular;  // all else; negative where the view sees less than `diffuse`
};

// Noise of one object's layers, estimated while it was traced: PSNR in decibels of sRGB codes between two renderings with
// different seeds; 0 where the object is not seen, 99 where there is none.
struct NoiseReport {
  int object = 0;
  double diffuse_db = 0, specular_db = 0;
};

struct Frame {
  int width = 0, height = 0;
  std::vector<glm::vec3> combined;   // filtered radiance of the whole picture = sum of coverage * (diffuse + specular)
  std::vector<ObjectFrame> objects;  // empty when layers were not asked for
  std::vector<NoiseReport> noise;    // per object that is seen; empty where it was not estimated (a frame from a file)
  double rays_per_pixel = 0;         // camera rays, in the mean
};

// body(i, j) for every pixel within both data windows, rows top first: its number in `a`'s arrays and in `b`'s.
template <typename Body>
void for_each_common_pixel(const ObjectFrame& a, const ObjectFrame& b, const Body& body) {
  for (int y = std::max(a.y, b.y); y < std::min(a.y + a.height, b.y + b.height); ++y)
    for (int x = std::max(a.x, b.x); x < std::min(a.x + a.width, b.x + b.width); ++x)
      body(static_cast<size_t>((y - a.y) * a.width + x - a.x), static_cast<size_t>((y - b.y) * b.width + x - b.x));
}

}  // namespace vitrine
