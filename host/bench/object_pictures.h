// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// An object's own picture, as tracer and target both have it: the light of the parts of a pixel where it is seen in front of all
// others, through the pixel filter, divided by its coverage. So no texture is charged for another object's, nor for edges, which
// no texture can change; pixels that the object covers by half or more count, in both.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/infer/verification.h"
#include "host/trace/frame.h"
#include "host/verify/verify.h"

namespace vitrine {

// 8-bit sRGB codes in a window of the picture.
struct ObjectPicture {
  int x = 0, y = 0, width = 0, height = 0;
  std::vector<uint8_t> rgb;
  std::vector<float> coverage;
};

const ObjectFrame* find_object(const Frame& frame, int object);               // null: not seen
ObjectPicture traced_object(const Frame& frame, int object, float exposure);  // empty where it is not seen
// `picture`: as ObjectDrawer gives it, `columns` wide.
ObjectPicture drawn_object(const std::vector<glm::vec4>& picture, int columns, const ObjectPicture& window, float exposure);
// Windows of two pictures need not be equal; what counts lies in both.
ObjectPicture in_window_of(const ObjectPicture& picture, const ObjectPicture& window);

// Squared differences of codes.
struct CodeError {
  double squares = 0;
  int64_t values = 0;
  void add(const ObjectPicture& a, const ObjectPicture& b);  // of equal windows
  double psnr() const;                                       // dB
};

Picture crop_of(const ObjectPicture& picture);  // the window with a margin; grey where the object does not count

// Draws single objects of one state, hidden by all others.
class ObjectDrawer {
 public:
  ObjectDrawer(hal::Gpu& gpu, const InferenceOptions& options, std::span<const DrawnObject> objects, GeometryState state);
  ~ObjectDrawer();
  ObjectDrawer(const ObjectDrawer&) = delete;
  ObjectDrawer& operator=(const ObjectDrawer&) = delete;

  // Its light times its coverage, and its coverage, rows top first.
  std::vector<glm::vec4> draw(size_t object, const std::vector<LaidTexture>& textures);

 private:
  hal::Gpu& gpu_;
  InferenceOptions options_;
  TestRenderer renderer_;
  GeometryState state_;
  hal::Texture clear_;
};

}  // namespace vitrine
