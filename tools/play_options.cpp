// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "tools/play_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "tools/axis_position.h"
#include <vector>

namespace vitrine {
namespace {

constexpr char kFooter[] = R"(
Examples:
  vitrine-play table.vit                                        in a window: arrows, mouse or gamepad turn the axes
  vitrine-play table.vit --at view=0.5,lamp=#3 --out still.png  one picture
  vitrine-play table.vit --script path.csv --out frames         a picture per frame
  vitrine-play table.vit --backend null --script path.csv --stats --json

Keys: arrows or A D W S move the first and second axis (Shift: faster), mouse drag and wheel too; Home: back to the start;
Space: pause the script; F1: figures; F11: full screen; F12: screenshot; Esc: quit.
A script is CSV: a header "frame,AXIS,AXIS,..." and rows of a frame number and positions from 0 to 1.)";

bool set_in_environment(const char* name) {
  const char* value = std::getenv(name);
  return value && *value;
}

void check_combination(const PlayOptions& options) {
  if (options.backend == Backend::kNull && !options.out.empty()) throw UsageError("--out: the null backend draws nothing to write: leave one of them out");
  if (options.still() && (!options.script.empty() || options.frames))
    throw UsageError("--out FILE.png is one still: with --script or --frames give a folder");
  if (const std::string ending = std::filesystem::path(options.out).extension(); !options.still() && !ending.empty())
    throw UsageError("--out " + options.out + ": give a name that ends in .png for a still, or a folder without an ending for frames");
}

}  // namespace

std::optional<PlayOptions> parse_options(int argc, char** argv) {
  PlayOptions options;
  int64_t frames = 0;
  const CLI::Validator not_empty([](const std::string& text) { return std::string(text.empty() ? "is empty" : ""); }, "");
  Backend backend = Backend::kOsmesa;
  CLI::App app("Plays a Vitrine image: a photoreal picture that answers dials.", "vitrine-play");
  app.footer(kFooter);
  app.set_version_flag("--version", "vitrine-play " VITRINE_VERSION);
  app.add_option("IMAGE", options.image, "the image, as vitrine compile wrote it")->required()->check(not_empty)->type_name("");
  const std::map<std::string, Backend> backends{{"sdl", Backend::kSdl}, {"osmesa", Backend::kOsmesa}, {"null", Backend::kNull}};
  auto* backend_option =
      app.add_option("--backend", backend, "sdl: a window; osmesa: off screen, in software; null: draws nothing");
  backend_option->transform(CLI::Transformer(backends).description(""))->type_name("sdl|osmesa|null");
  app.add_option("--at", options.at, "where to start: positions from 0 to 1, or grid samples as #17")->check(not_empty)->type_name("AXIS=P,...");
  app.add_option("--script", options.script, "positions to play, frame by frame")->check(not_empty)->type_name("FILE.csv");
  auto* frames_option =
      app.add_option("--frames", frames, fmt::format("how many frames to play (else: to the script's end; in a window until it is closed; off screen {})", kFramesWithoutEnd))->check(CLI::Range(int64_t{1}, int64_t{1} << 53).description(""))->type_name("N");
  app.add_option("--out", options.out, "a still at --at, decoded in full; or a folder for numbered frames")->check(not_empty)
      ->type_name("F.png|DIR");
  app.add_flag("--stats", options.stats, "print frame times, decoding units, late nodes at the end");
  app.add_flag("--json", options.json, "print the same as one JSON object on stdout");
  app.add_flag("--full-screen", options.full_screen, "start with the whole screen");
  app.add_flag("--quiet", options.quiet, "print errors only");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    app.exit(asked);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    throw UsageError(std::string(error.what()) + ": see vitrine-play --help");
  }
  if (*frames_option) options.frames = frames;
  if (*backend_option) options.backend = backend;
  check_combination(options);
  return options;
}

// Pictures are made without a window unless one is asked for.
Backend backend_of(const PlayOptions& options) {
  if (options.backend) return *options.backend;
  const bool display = set_in_environment("DISPLAY") || set_in_environment("WAYLAND_DISPLAY");
  return display && options.out.empty() ? Backend::kSdl : Backend::kOsmesa;
}

std::string axis_name(const ImageView& image, int axis) {
  return image.directory().axes()->Get(static_cast<uint32_t>(axis))->name()->str();
}

Position parse_position(const std::string& text, const ImageView& image) {
  std::vector<std::string> names;
  for (int a = 0; a < image.space().axis_count; ++a) names.push_back(axis_name(image, a));
  try {
    return parse_position(text, names, image.space());
  } catch (const PositionError& error) {
    throw UsageError(std::string("--at: ") + error.what());
  }
}

}  // namespace vitrine
