// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "tools/commands/image_input.h"

#include <fmt/format.h>

#include <algorithm>

#include "host/base/error.h"
#include "host/compile/compile.h"
#include "host/compile/preset.h"
#include "tools/bus_error.h"
#include "tools/commands/scene_input.h"

namespace vitrine {
namespace {

GridOfImage grid_of(const ImageView& image) {
  GridOfImage grid;
  grid.width = static_cast<int>(image.directory().width());
  grid.height = static_cast<int>(image.directory().height());
  grid.paths_per_pixel = static_cast<int>(image.directory().paths_per_pixel());
  grid.noise_db = image.directory().noise_db();
  for (const fb::Axis* axis : *image.directory().axes()) grid.axes.emplace_back(axis->name()->str(), static_cast<int>(axis->samples()));
  return grid;
}

// Axes may well be called alike in two scenes; objects hardly are.
void check_objects(const ImageView& image, const Scene& scene, const std::string& name) {
  for (const fb::Object* object : *image.directory().objects())
    if (std::none_of(scene.objects.begin(), scene.objects.end(), [&](const Object& o) { return o.name == object->name()->str(); }))
      throw InputError(name, "it shows \"" + object->name()->str() + "\", which " + scene.file.string() + " does not have", "name the scene that it was compiled from");
}

}  // namespace

OpenImage::OpenImage(const std::string& path) {
  explain_bus_errors("vitrine", path);
  auto file = hal::MappedFile::open(path.c_str());
  if (!file.ok()) throw InputError(path, file.status().detail(), "name an image that vitrine compile wrote");
  file_ = std::move(file.value());
  const auto opened = ImageView::open(file_.bytes());
  if (!opened.ok()) throw InputError(path, opened.status().detail(), "compile it again");
  view_ = opened.value();
}

std::unique_ptr<const Scene> load_scene_of(const ImageView& image, const std::string& image_path, const std::string& scene_path,
                                           const CommonOptions& options) {
  auto scene = load_scene_with(scene_path, options, [&](Scene& s) { apply_grid(s, grid_of(image), image_path); });
  check_objects(image, *scene, image_path);
  if (const uint64_t key = image.directory().frames_key(); !options.quiet && key != 0 && key != frames_key(frame_keys(*scene)))
    fmt::print(stderr, "vitrine: warning: {}: {} has changed since it was compiled: the figures compare it with what the scene shows now\n",
               image_path, scene_path);
  return scene;
}

}  // namespace vitrine
