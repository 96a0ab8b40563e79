// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "host/scene/new_scene.h"
#include "tools/commands/commands.h"

namespace vitrine {

void add_new_command(CLI::App& app) {
  struct Options {
    std::string directory, model;
    CommonOptions common;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("new", "Write a scene folder to start from; it compiles at once");
  command->add_option("DIR", options->directory, "Folder to create")->required();
  command->add_option("--from", options->model, "Model to start from (.glb or .gltf); without it a small model is written");
  add_common_options(*command, options->common);
  command->footer("Example: vitrine new shop --from lamp.glb");
  command->callback([options] {
    new_scene(options->directory, options->model.empty() ? std::nullopt : std::optional<std::filesystem::path>(options->model));
    if (options->common.json)
      fmt::print("{}\n", nlohmann::json{{"scene", options->directory + "/scene.toml"}}.dump());
    else if (!options->common.quiet)
      fmt::print("wrote {0}/scene.toml; next: vitrine compile {0} -o {0}.vit --preset tiny\n", options->directory);
  });
}

}  // namespace vitrine
