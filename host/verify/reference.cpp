// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/verify/reference.h"

#include <algorithm>

#include "formats/color.h"
#include "host/base/error.h"

namespace vitrine {
namespace {

// Seeds of references lie apart from those of the frames that were compiled (0).
constexpr uint32_t kFirstSeed = 0x7e500000;

// What a display shows of it, in 8-bit units.
double srgb(float radiance) {
  const double shown = radiance > 0 ? std::min(radiance, 1.0f) : 0.0;
  return 255 * srgb_from_linear(shown);
}

std::vector<int> covered_pixels(const ObjectFrame& object, int frame_width) {
  std::vector<int> pixels;
  for (int y = 0; y < object.height; ++y)
    for (int x = 0; x < object.width; ++x)
      if (object.coverage[static_cast<size_t>(y) * object.width + x] >= 0.5f) pixels.push_back((object.y + y) * frame_width + object.x + x);
  return pixels;
}

}  // namespace

uint8_t srgb8_from_radiance(float radiance) { return static_cast<uint8_t>(srgb(radiance) + 0.5); }

Reference::Reference(const Scene& scene, const Store& store, Tracer& tracer, const Position& position)
    : scene_(scene), store_(store), tracer_(tracer), position_(position), scene_key_(scene_key(scene)), pixels_(scene.objects.size()) {
  for (auto& sum : sum_) sum.assign(static_cast<size_t>(scene.settings.width) * scene.settings.height, glm::vec3(0));
}

void Reference::add(int half, int paths, uint32_t seed, Progress& progress) {
  const TraceOptions options{scene_.settings.width, scene_.settings.height, paths, seed, true};
  const StoreKey key = frame_key(scene_key_, scene_, position_, options);
  auto frame = store_.load_frame(key, scene_);
  if (!frame) {
    store_.save_frame(key, scene_, tracer_.render(position_, options, progress));
    frame = store_.load_frame(key, scene_);  // what a later run will see: rounded to half
  }
  if (!frame) throw InputError("work folder", "a reference could not be stored", "check that it is writable and has room");
  for (size_t i = 0; i < sum_[half].size(); ++i) sum_[half][i] += frame->combined[i] * static_cast<float>(paths);
  if (paths_ == 0 && half == 0)
    for (const ObjectFrame& object : frame->objects) pixels_[object.object] = covered_pixels(object, frame->width);
}

void Reference::refine(Progress& progress) {
  const int paths = paths_ == 0 ? kFirstPaths / 2 : paths_ / 2;
  for (int half = 0; half < 2; ++half) add(half, paths, kFirstSeed + 2 * round_ + half, progress);
  paths_ += 2 * paths;
  ++round_;
}

Picture Reference::picture() const {
  Picture picture{scene_.settings.width, scene_.settings.height, {}};
  picture.rgb.reserve(3 * sum_[0].size());
  const float scale = scene_.settings.exposure / static_cast<float>(paths_);
  for (size_t i = 0; i < sum_[0].size(); ++i)
    for (int c = 0; c < 3; ++c) picture.rgb.push_back(srgb8_from_radiance((sum_[0][i][c] + sum_[1][i][c]) * scale));
  return picture;
}

double Reference::noise() const {
  const float scale = scene_.settings.exposure / static_cast<float>(paths_ / 2);
  double sum = 0;
  for (size_t i = 0; i < sum_[0].size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double difference = srgb(sum_[0][i][c] * scale) - srgb(sum_[1][i][c] * scale);
      sum += difference * difference;
    }
  }
  return sum / (3.0 * static_cast<double>(sum_[0].size())) / 4;
}

}  // namespace vitrine
