// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Scenes as the subcommands read them.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "host/scene/scene.h"
#include "tools/commands/commands.h"

namespace vitrine {

// Loads, lets `adjust` apply a preset or a grid, prints the scene's warnings on stderr, and what it leaves out of the light (unless quiet).
std::unique_ptr<const Scene> load_scene_with(const std::string& path, const CommonOptions& options, const std::function<void(Scene&)>& adjust);

// The size of pictures as --size tells it, "640x480", into the scene's settings; "" leaves them. Throws InputError.
void apply_size(Scene& scene, const std::string& size);

// Where frames and textures of an image are kept unless --work says otherwise: lamp.vit -> lamp.work.
std::filesystem::path default_work_folder(const std::string& image);

}  // namespace vitrine
