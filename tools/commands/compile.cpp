// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/compile/compile.h"
#include "host/compile/preset.h"
#include "tools/commands/commands.h"
#include "tools/commands/scene_input.h"

namespace vitrine {
namespace {

struct Options {
  std::string scene, image, preset = "full", profile, storage, codec = "dct", work;
  CommonOptions common;
};

void run(const Options& options) {
  const auto jobs = limit_jobs(options.common);
  const auto progress = make_progress(options.common);
  const auto scene = load_scene_with(options.scene, options.common, [&](Scene& s) { apply_preset(s, options.preset); });
  CompileOptions compile;
  compile.image = options.image;
  compile.work = options.work.empty() ? default_work_folder(options.image) : std::filesystem::path(options.work);
  compile.profile = options.profile;
  compile.storage = options.storage;
  const CompileReport report = compile_scene(*scene, compile, *progress);
  if (!options.common.quiet)
    for (const std::string& warning : report.warnings) fmt::print(stderr, "vitrine: warning: {}\n", warning);
  const double ratio = static_cast<double>(report.raw_bytes) / static_cast<double>(report.bytes);
  if (options.common.json) {
    fmt::print("{}\n", nlohmann::json{{"image", options.image}, {"bytes", report.bytes}, {"raw_bytes", report.raw_bytes}, {"ratio", ratio},
                                      {"frames", report.frames}, {"frames_rendered", report.frames_rendered}, {"seconds", report.seconds}}.dump());
  } else if (!options.common.quiet) {
    fmt::print("{}: {} bytes, {:.1f}:1, {} frames ({} traced now), {:.1f} s\n", options.image, report.bytes, ratio, report.frames,
               report.frames_rendered, report.seconds);
  }
}

}  // namespace

void add_compile_command(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("compile", "Trace, infer, encode and link a scene into an image");
  command->add_option("SCENE", options->scene, "Folder with scene.toml, or a .toml file")->required();
  command->add_option("-o,--output", options->image, "Image to write (.vit)")->required();
  command->add_option("--preset", options->preset, "tiny (a look), small (a demo), full (as the scene says)")->capture_default_str()->check(CLI::IsMember({"tiny", "small", "full"}));
  command->add_option("--profile", options->profile, "Target profile instead of the scene's: a built-in name or a file");
  command->add_option("--storage", options->storage, "Storage instead of the scene's: \"100:1\", \"150 KB/block\", \"12 MB\"");
  command->add_option("--codec", options->codec, "Node coder")->capture_default_str()->check(CLI::IsMember({"dct"}));
  command->add_option("--work", options->work, "Folder for frames and textures; keep it to resume and recompile quickly (default: IMAGE.work)");
  add_common_options(*command, options->common);
  command->footer("Example: vitrine compile shop -o lamp.vit --preset small");
  command->callback([options] { run(*options); });
}

}  // namespace vitrine
