// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "host/scene/new_scene.h"
#include "tools/commands/commands.h"

namespace vitrine {

void NewCommand::run() const {
  new_scene(directory, model.empty() ? std::nullopt : std::optional<std::filesystem::path>(model));
  if (common.json)
    fmt::print("{}\n", nlohmann::json{{"scene", directory + "/scene.toml"}}.dump());
  else if (!common.quiet)
    fmt::print("wrote {0}/scene.toml; next: vitrine compile {0} -o {0}.vit --preset tiny\n", directory);
}

}  // namespace vitrine
