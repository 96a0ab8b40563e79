// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hal/storage.h"
#include "host/base/error.h"
#include "host/compile/compile.h"
#include "host/frames/store.h"
#include "host/trace/tracer.h"
#include "host/verify/reference.h"
#include "tools/axis_position.h"
#include "tools/commands/commands.h"
#include "tools/commands/scene_input.h"
#include "tools/png.h"

namespace vitrine {
namespace {

struct Options {
  std::string scene, at, size, output;
  int samples_per_pixel = 0;
  uint32_t seed = 0;
  bool layers = false;
  CommonOptions common;
};

bool ends_with(const std::string& text, const char* suffix) {
  const std::string s = suffix;
  return text.size() >= s.size() && text.compare(text.size() - s.size(), s.size(), s) == 0;
}

// "640x480" into the scene's settings.
void apply_size(Scene& scene, const std::string& size) {
  if (size.empty()) return;
  int width = 0, height = 0;
  char extra = 0;
  if (std::sscanf(size.c_str(), "%dx%d%c", &width, &height, &extra) != 2 || width < 1 || height < 1 || width > 16384 || height > 16384)
    throw InputError("--size " + size, "it is not a size", "write WIDTHxHEIGHT, as 640x480, up to 16384 each");
  scene.settings.width = width;
  scene.settings.height = height;
}

void write_picture(const std::string& file, const Frame& frame, float exposure) {
  std::vector<uint8_t> rgb;
  rgb.reserve(frame.combined.size() * 3);
  for (const glm::vec3& radiance : frame.combined)
    for (int c = 0; c < 3; ++c) rgb.push_back(srgb8_from_radiance(radiance[c] * exposure));
  const Status status = write_png(file, frame.width, frame.height, rgb);
  if (!status.ok()) throw InputError(file, status.detail(), "check that the folder exists and has room");
}

void write_layers(const std::string& file, const Scene& scene, const Frame& frame) {
  const std::string exr = exr_of_frame(scene, frame);
  const Status status = hal::write_file_atomically(file.c_str(), std::as_bytes(std::span(exr)));
  if (!status.ok()) throw InputError(file, status.detail(), "check that the folder exists and has room");
}

void run(const Options& options) {
  if (!ends_with(options.output, ".exr") && !ends_with(options.output, ".png"))
    throw InputError(options.output, "its ending says no format", "end it in .exr (linear) or .png (sRGB)");
  if (options.layers && !ends_with(options.output, ".exr")) throw InputError(options.output, "a PNG holds no layers", "write an .exr, or leave --layers out");
  const auto jobs = limit_jobs(options.common);
  const auto progress = make_progress(options.common);
  const auto scene = load_scene_with(options.scene, options.common, [&](Scene& s) {
    apply_size(s, options.size);
    if (options.samples_per_pixel > 0) s.settings.samples_per_pixel = options.samples_per_pixel;
  });
  std::vector<std::string> names;
  for (const Axis& axis : scene->axes) names.push_back(axis.name);
  Position position;
  try {
    position = parse_position(options.at, names, scene->space());
  } catch (const PositionError& error) {
    throw CLI::ValidationError("--at", error.what());
  }

  TraceOptions trace = trace_options(*scene);
  trace.seed = options.seed;
  trace.layers = options.layers;
  Tracer tracer(*scene);
  const Frame frame = tracer.render(position, trace, progress.get());
  if (ends_with(options.output, ".exr"))
    write_layers(options.output, *scene, frame);
  else
    write_picture(options.output, frame, scene->settings.exposure);
  if (options.common.json)
    fmt::print("{}\n", nlohmann::json{{"output", options.output}, {"width", frame.width}, {"height", frame.height}, {"samples_per_pixel", trace.samples_per_pixel}}.dump());
}

}  // namespace

void add_render_command(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("render", "Path-trace one picture of a scene");
  command->add_option("SCENE", options->scene, "Folder with scene.toml, or a .toml file")->required();
  command->add_option("--at", options->at, "Where: AXIS=POSITION in [0,1] or AXIS=#SAMPLE, separated by commas (default: 0 everywhere)");
  command->add_option("--spp", options->samples_per_pixel, "Paths per pixel instead of the scene's")->check(CLI::Range(1, 1 << 20));
  command->add_option("--size", options->size, "WIDTHxHEIGHT instead of the scene's");
  command->add_option("--seed", options->seed, "Another seed gives independent noise");
  command->add_flag("--layers", options->layers, "Also write each object's diffuse, specular and coverage (.exr)");
  command->add_option("-o,--output", options->output, "Picture to write: .exr (linear) or .png (sRGB)")->required();
  add_common_options(*command, options->common);
  command->footer("Example: vitrine render shop --at view=0.5,lamp=#2 --spp 64 -o look.png");
  command->callback([options] { run(*options); });
}

}  // namespace vitrine
