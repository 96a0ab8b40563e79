// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The content-addressed store of what was computed: one OpenEXR file per frame, one per inferred texture, each named by a
// 128-bit hash of everything that it depends on. A killed compile resumes, an axis that grows renders only its new samples,
// two machines can fill one store. Files appear whole or not at all (written beside, synced, renamed); a damaged file counts
// as absent. Layout: DIR/frames/ab/ab34...ef.exr, DIR/textures/...
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/scene/scene.h"
#include "host/trace/frame.h"
#include "host/trace/tracer.h"

namespace vitrine {

struct StoreKey {
  uint64_t high = 0, low = 0;
  std::string hex() const;
  bool operator==(const StoreKey&) const = default;
};

// XXH3-128 over typed appends; order matters.
class KeyBuilder {
 public:
  KeyBuilder();
  ~KeyBuilder();
  KeyBuilder(const KeyBuilder& other);
  void bytes(const void* data, size_t size);
  void text(const std::string& text);
  void number(double value);
  void integer(int64_t value);
  StoreKey finish() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Everything in the scene that light depends on, whatever the position: geometry, materials, images, lights, environment,
// camera lens. Not names, axes' sample counts, target settings.
StoreKey scene_key(const Scene& scene);
// One frame: the scene's key, the pose at the position (not the position itself, so that a regrouped axis still hits), the
// options, the tracer's version.
StoreKey frame_key(const StoreKey& scene_key, const Scene& scene, const Position& position, const TraceOptions& options);

// Planes of half floats with names, all of one size: what inference stores.
struct LayeredImage {
  int width = 0, height = 0;
  struct Plane {
    std::string name;
    std::vector<float> values;
  };  // rows top first
  std::vector<Plane> planes;
};

// The OpenEXR file that save_frame writes.
std::string exr_of_frame(const Scene& scene, const Frame& frame);

class Store {
 public:
  explicit Store(std::filesystem::path directory);  // created where it is missing; throws InputError where it cannot be

  bool has_frame(const StoreKey& key) const;
  // Multi-part OpenEXR: part 0 "combined" with R, G, B; then one part per visible object named after it, cropped to its data
  // window, channels OBJECT.diffuse.{R,G,B}, OBJECT.specular.{R,G,B}, OBJECT.coverage.Y. Half, ZIP.
  void save_frame(const StoreKey& key, const Scene& scene, const Frame& frame) const;
  std::optional<Frame> load_frame(const StoreKey& key, const Scene& scene) const;

  bool has_planes(const StoreKey& key) const;
  void save_planes(const StoreKey& key, const LayeredImage& image) const;
  std::optional<LayeredImage> load_planes(const StoreKey& key) const;

 private:
  std::filesystem::path directory_;
};

}  // namespace vitrine
