// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Camera samples become a Frame: per pixel plain means (samples are distributed as the pixel filter), per object cropped layers.
// Sums stay until the frame is made, so that samples may come in several passes.
#pragma once

#include <array>
#include <vector>

#include "host/trace/frame.h"
#include "host/trace/integrator.h"

namespace vitrine::trace {

// Samples of one quantity.
struct SampleSum {
  int count = 0;
  glm::dvec3 sum{0};
  glm::vec3 visible{0}, squares{0};  // sums of samples and their squares, each cut at a limit

  void add(const glm::vec3& value, float limit);
  glm::vec3 mean() const { return count ? glm::vec3(sum / static_cast<double>(count)) : glm::vec3(0); }
  // Of a single sample, cut at the limit, per channel; unbiased. 0 below two samples.
  glm::vec3 variance() const;
};

// One object in one pixel.
struct PixelObject {
  int object = -1;   // -1: nothing was met
  int next = -1;     // in the tile's pool: what else the pixel shows
  int samples = 0;   // camera samples that met it
  SampleSum diffuse, view, specular;  // as in CameraSample; `view` has as many samples as `diffuse`

  glm::vec3 radiance() const { return diffuse.mean() + view.mean() + specular.mean(); }
};

inline constexpr int kTile = 16;  // pixels

// The samples of one tile of the picture. Pixels are numbered y * kTile + x within it.
class TileSums {
 public:
  TileSums() { first_.fill(-1); }
  // The entry of `object` in the pixel, made where there is none.
  PixelObject& entry(int pixel, int object);
  // `limit`: of radiance, beyond which samples do not count for more in variances: on a display they are all white.
  static void add(PixelObject& entry, const CameraSample& sample, float limit);
  int samples(int pixel) const { return samples_[static_cast<size_t>(pixel)]; }  // camera samples of the pixel
  void count_sample(int pixel) { ++samples_[static_cast<size_t>(pixel)]; }

  // All entries of the pixel, in the order of first appearance.
  template <typename Body>
  void for_each(int pixel, const Body& body) const {
    for (int i = first_[static_cast<size_t>(pixel)]; i >= 0; i = pool_[static_cast<size_t>(i)].next) body(pool_[static_cast<size_t>(i)]);
  }

 private:
  std::array<int, static_cast<size_t>(kTile) * kTile> first_, samples_{};
  std::vector<PixelObject> pool_;
};

// All tiles of a picture, row by row.
class Film {
 public:
  Film(int width, int height);
  int width() const { return width_; }
  int height() const { return height_; }
  int tile_count() const { return static_cast<int>(tiles_.size()); }
  TileSums& tile(int index) { return tiles_[static_cast<size_t>(index)]; }
  const TileSums& tile_at(int x, int y) const { return tiles_[static_cast<size_t>(y / kTile * columns_ + x / kTile)]; }
  static int pixel_in_tile(int x, int y) { return y % kTile * kTile + x % kTile; }
  // The left upper pixel of a tile.
  glm::ivec2 corner(int tile) const { return {tile % columns_ * kTile, tile / columns_ * kTile}; }

  // Mean radiance of every pixel, and with `layers` one window per object that is seen, by ascending object.
  Frame frame(bool layers, int object_count) const;

 private:
  std::vector<ObjectFrame> object_frames(int object_count) const;
  template <typename Body>
  void for_each_pixel(const Body& body) const {  // body(x, y, tile, pixel)
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) body(x, y, tile_at(x, y), pixel_in_tile(x, y));
  }

  int width_, height_, columns_;
  std::vector<TileSums> tiles_;
};

}  // namespace vitrine::trace
