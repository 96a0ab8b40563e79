// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/film.h"

namespace vitrine::trace {
namespace {

// Rare products of huge and tiny numbers: better one lost sample than a ruined pixel.
glm::vec3 finite(const glm::vec3& light) {
  return std::isfinite(light.x + light.y + light.z) ? light : glm::vec3(0);
}

struct Box {
  int x0 = 1 << 30, y0 = 1 << 30, x1 = -1, y1 = -1;
};

}  // namespace

void SampleSum::add(const glm::vec3& value, float limit) {
  const glm::vec3 v = finite(value), cut = glm::clamp(v, glm::vec3(-limit), glm::vec3(limit));
  ++count;
  sum += glm::dvec3(v);
  visible += cut;
  squares += cut * cut;
}

glm::vec3 SampleSum::variance() const {
  if (count < 2) return glm::vec3(0);
  const auto n = static_cast<float>(count);
  const glm::vec3 m = visible / n;
  return glm::max(squares - n * m * m, glm::vec3(0)) / (n - 1);
}

PixelObject& TileSums::entry(int pixel, int object) {
  int* link = &first_[static_cast<size_t>(pixel)];
  while (*link >= 0) {
    PixelObject& found = pool_[static_cast<size_t>(*link)];
    if (found.object == object) return found;
    link = &found.next;
  }
  *link = static_cast<int>(pool_.size());
  PixelObject& made = pool_.emplace_back();
  made.object = object;
  return made;
}

void TileSums::add(PixelObject& entry, const CameraSample& sample, float limit) {
  ++entry.samples;
  if (sample.layers.diffuse) {
    entry.diffuse.add(sample.diffuse, limit);
    entry.view.add(sample.view, limit);
  }
  if (sample.layers.specular) entry.specular.add(sample.specular, limit);
}

Film::Film(int width, int height) : width_(width), height_(height), columns_((width + kTile - 1) / kTile) {
  tiles_.resize(static_cast<size_t>(columns_) * static_cast<size_t>((height + kTile - 1) / kTile));
}

Frame Film::frame(bool layers, int object_count) const {
  Frame frame;
  frame.width = width_;
  frame.height = height_;
  frame.combined.reserve(static_cast<size_t>(width_) * static_cast<size_t>(height_));
  for_each_pixel([&](int, int, const TileSums& tile, int pixel) {
    glm::vec3 sum(0);
    const auto samples = static_cast<float>(std::max(1, tile.samples(pixel)));
    tile.for_each(pixel, [&](const PixelObject& o) { sum += static_cast<float>(o.samples) / samples * o.radiance(); });
    frame.combined.push_back(sum);
  });
  if (layers) frame.objects = object_frames(object_count);
  return frame;
}

std::vector<ObjectFrame> Film::object_frames(int object_count) const {
  std::vector<Box> boxes(static_cast<size_t>(object_count));
  for_each_pixel([&](int x, int y, const TileSums& tile, int pixel) {
    tile.for_each(pixel, [&](const PixelObject& o) {
      if (o.object < 0) return;
      Box& b = boxes[static_cast<size_t>(o.object)];
      b = {std::min(b.x0, x), std::min(b.y0, y), std::max(b.x1, x), std::max(b.y1, y)};
    });
  });
  std::vector<ObjectFrame> frames;
  std::vector<int> frame_of_object(boxes.size(), -1);
  for (size_t o = 0; o < boxes.size(); ++o) {
    const Box& b = boxes[o];
    if (b.x1 < 0) continue;
    frame_of_object[o] = static_cast<int>(frames.size());
    ObjectFrame f{static_cast<int>(o), b.x0, b.y0, b.x1 - b.x0 + 1, b.y1 - b.y0 + 1, {}, {}, {}};
    const size_t pixels = static_cast<size_t>(f.width) * static_cast<size_t>(f.height);
    f.coverage.assign(pixels, 0.0f);
    f.diffuse.assign(pixels, glm::vec3(0));
    f.specular.assign(pixels, glm::vec3(0));
    frames.push_back(std::move(f));
  }
  for_each_pixel([&](int x, int y, const TileSums& tile, int pixel) {
    tile.for_each(pixel, [&](const PixelObject& o) {
      if (o.object < 0) return;
      ObjectFrame& f = frames[static_cast<size_t>(frame_of_object[static_cast<size_t>(o.object)])];
      const size_t i = static_cast<size_t>(y - f.y) * static_cast<size_t>(f.width) + static_cast<size_t>(x - f.x);
      f.coverage[i] = static_cast<float>(o.samples) / static_cast<float>(tile.samples(pixel));
      f.diffuse[i] = o.diffuse.mean();
      f.specular[i] = o.specular.mean() + o.view.mean();
    });
  });
  return frames;
}

}  // namespace vitrine::trace
