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

void PixelSums::clear() {
  sums_.clear();
  total_ = glm::dvec3(0);
  samples_ = 0;
}

void PixelSums::add(const CameraSample& sample) {
  const glm::dvec3 diffuse(finite(sample.diffuse)), specular(finite(sample.specular));
  total_ += diffuse + specular;
  ++samples_;
  if (sample.object < 0) return;
  for (Sum& sum : sums_) {
    if (sum.object != sample.object) continue;
    ++sum.samples;
    sum.diffuse += diffuse;
    sum.specular += specular;
    return;
  }
  sums_.push_back({sample.object, 1, diffuse, specular});
}

glm::vec3 PixelSums::mean() const { return samples_ ? glm::vec3(total_ / static_cast<double>(samples_)) : glm::vec3(0); }

void PixelSums::append_records(int x, int y, std::vector<FilmRecord>& records) const {
  for (const Sum& sum : sums_) {
    const auto own = static_cast<double>(sum.samples);
    records.push_back(
        {sum.object, x, y, static_cast<float>(own / samples_), glm::vec3(sum.diffuse / own), glm::vec3(sum.specular / own)});
  }
}

std::vector<ObjectFrame> objects_from_records(const std::vector<std::vector<FilmRecord>>& tiles, int object_count) {
  std::vector<Box> boxes(static_cast<size_t>(object_count));
  for (const auto& tile : tiles) {
    for (const FilmRecord& r : tile) {
      Box& b = boxes[static_cast<size_t>(r.object)];
      b = {std::min(b.x0, r.x), std::min(b.y0, r.y), std::max(b.x1, r.x), std::max(b.y1, r.y)};
    }
  }
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
  for (const auto& tile : tiles) {
    for (const FilmRecord& r : tile) {
      ObjectFrame& f = frames[static_cast<size_t>(frame_of_object[static_cast<size_t>(r.object)])];
      const size_t i = static_cast<size_t>(r.y - f.y) * static_cast<size_t>(f.width) + static_cast<size_t>(r.x - f.x);
      f.coverage[i] = r.coverage;
      f.diffuse[i] = r.diffuse;
      f.specular[i] = r.specular;
    }
  }
  return frames;
}

}  // namespace vitrine::trace
