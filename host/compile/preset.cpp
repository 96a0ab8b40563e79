// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/compile/preset.h"

#include <algorithm>

#include "host/base/error.h"
#include "host/compile/compile.h"

namespace vitrine {
namespace {

// Pictures stay even in both dimensions, so that their halves are whole.
int divided(int size, int divisor) { return std::max(2, size / divisor / 2 * 2); }

// max_speed counts samples: what it means in the scene stays.
void set_samples(Axis& axis, int samples) {
  const int ends = axis.shape.kind == AxisKind::kPeriodic ? 0 : 1;
  if (axis.shape.samples > ends) axis.max_speed *= static_cast<float>(samples - ends) / static_cast<float>(axis.shape.samples - ends);
  axis.shape.samples = samples;
}

template <typename Reduce>
void reduce_axes(Scene& scene, Reduce reduce) {
  for (Axis& axis : scene.axes) {
    if (axis.shape.kind == AxisKind::kDiscrete) continue;
    set_samples(axis, std::min(axis.shape.samples, reduce(axis.shape.samples)));
  }
}

}  // namespace

void apply_preset(Scene& scene, const std::string& name) {
  Settings& settings = scene.settings;
  if (name == "full") return;
  if (name == "small") {
    settings.width = divided(settings.width, 2);
    settings.height = divided(settings.height, 2);
    settings.noise_db = std::max(10.0f, settings.noise_db - 9);
    reduce_axes(scene, [](int samples) { return std::max(2, (samples + 1) / 2); });
  } else if (name == "tiny") {
    // So few samples share nothing: a ratio that suits the whole scene would not even hold the meshes.
    settings.storage = std::to_string(storage_bytes(settings.storage, scene, scene.file.string())) + " B";
    settings.width = divided(settings.width, 4);
    settings.height = divided(settings.height, 4);
    settings.noise_db = std::max(10.0f, settings.noise_db - 18);
    settings.samples_per_pixel = std::min(settings.samples_per_pixel, 8);
    reduce_axes(scene, [](int) { return 3; });
  } else {
    throw InputError("--preset " + name, "there is no such preset", "use tiny, small or full");
  }
}

void apply_grid(Scene& scene, const GridOfImage& grid, const std::string& image_name) {
  bool same = grid.axes.size() == scene.axes.size();
  for (size_t a = 0; same && a < scene.axes.size(); ++a) same = grid.axes[a].first == scene.axes[a].name;
  if (!same) throw InputError(image_name, "its axes are not those of " + scene.file.string(), "name the scene that it was compiled from");
  for (size_t a = 0; a < scene.axes.size(); ++a) scene.axes[a].shape.samples = grid.axes[a].second;
  scene.settings.width = grid.width;
  scene.settings.height = grid.height;
  scene.settings.samples_per_pixel = grid.paths_per_pixel;
  scene.settings.noise_db = grid.noise_db;
}

}  // namespace vitrine
