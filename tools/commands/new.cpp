// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "host/scene/new_scene.h"
#include "tools/commands/commands.h"
#include "tools/commands/print_json.h"

namespace vitrine {

namespace {

// As a shell takes it for one argument.
std::string quoted(const std::string& text) {
  if (text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-+,=@:") == std::string::npos) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

// DIR as a command names it best: not ending in a slash, not beginning like an option.
std::string as_argument(const std::string& directory) {
  std::filesystem::path path = std::filesystem::path(directory).lexically_normal();
  if (!path.has_filename() && path.has_relative_path()) path = path.parent_path();
  return path.native().starts_with('-') ? "./" + path.native() : path.native();
}

std::string image_of(const std::string& folder) {
  const std::string name = std::filesystem::path(folder).filename().string();
  return name.empty() || name.starts_with('.') ? "scene.vit" : folder + ".vit";
}

}  // namespace

void NewCommand::run() const {
  new_scene(directory, model.empty() ? std::nullopt : std::optional<std::filesystem::path>(model));
  const std::string folder = as_argument(directory);
  if (common.json)
    print_json({{"scene", (std::filesystem::path(folder) / "scene.toml").string()}});
  else if (!common.quiet)
    fmt::print("wrote {}; next: vitrine compile {} -o {} --preset tiny\n", (std::filesystem::path(folder) / "scene.toml").string(), quoted(folder),
               quoted(image_of(folder)));
}

}  // namespace vitrine
