// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "tools/commands/scene_input.h"

#include <cstdio>

#include "host/base/error.h"

namespace vitrine {

std::unique_ptr<const Scene> load_scene_with(const std::string& path, const CommonOptions& options, const std::function<void(Scene&)>& adjust) {
  std::unique_ptr<Scene> scene = load_scene(path);
  adjust(*scene);
  if (options.quiet) return scene;
  for (const std::string& warning : scene->warnings) std::fprintf(stderr, "vitrine: warning: %s\n", warning.c_str());
  if (scene->settings.max_radiance > 0)
    std::fprintf(stderr, "vitrine: note: max_radiance bounds one path's indirect light at %g: fewer fireflies, and a little less light than there is\n",
                 static_cast<double>(scene->settings.max_radiance));
  return scene;
}

void apply_size(Scene& scene, const std::string& size) {
  if (size.empty()) return;
  int width = 0, height = 0;
  char extra = 0;
  if (std::sscanf(size.c_str(), "%dx%d%c", &width, &height, &extra) != 2 || width < 1 || height < 1 || width > 16384 || height > 16384)
    throw InputError("--size " + size, "it is not a size", "write WIDTHxHEIGHT, as 640x480, up to 16384 each");
  scene.settings.width = width;
  scene.settings.height = height;
}

std::filesystem::path default_work_folder(const std::string& image) { return std::filesystem::path(image).replace_extension(".work"); }

}  // namespace vitrine
