// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// All subcommands in one file: CLI11 takes a compiler longer to read than all of them together.
#include "tools/commands/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "tools/commands/commands.h"
#include "tools/usage_error.h"

namespace vitrine {
namespace {

const CLI::Validator kNotEmpty([](const std::string& text) { return std::string(text.empty() ? "is empty" : ""); }, "");

void add_common_options(CLI::App& command, CommonOptions& options) {
  command.add_flag("--quiet", options.quiet, "No progress");
  command.add_flag("--json", options.json, "One JSON object on standard output and nothing else there");
  command.add_option("--jobs", options.jobs, "Threads (default: all cores); the result does not depend on it")->check(CLI::Range(1, 1024));
}

void add_new(CLI::App& app, NewCommand& options) {
  CLI::App* command = app.add_subcommand("new", "Write a scene folder to start from; it compiles at once");
  command->add_option("DIR", options.directory, "Folder to create")->required()->check(kNotEmpty);
  command->add_option("--from", options.model, "Model to start from (.glb or .gltf); without it a small model is written")->check(kNotEmpty);
  add_common_options(*command, options.common);
  command->footer("Example: vitrine new shop --from lamp.glb");
}

void add_render(CLI::App& app, RenderCommand& options) {
  CLI::App* command = app.add_subcommand("render", "Path-trace one picture of a scene");
  command->add_option("SCENE", options.scene, "Folder with scene.toml, or a .toml file")->required()->check(kNotEmpty);
  command->add_option("--at", options.at, "Where: AXIS=POSITION in [0,1] or AXIS=#SAMPLE, separated by commas (default: 0 everywhere)")->check(kNotEmpty);
  command->add_option("--spp", options.samples_per_pixel, "Camera rays of every pixel instead of the scene's; with --noise of a pixel in the mean, at most")->check(CLI::Range(1, 1 << 20));
  command->add_option("--noise", options.noise_db, "Give rays where they are needed, until two seeds would agree to so many dB in every object's layers")->check(CLI::Range(10, 80));
  command->add_option("--size", options.size, "WIDTHxHEIGHT instead of the scene's")->check(kNotEmpty);
  command->add_option("--seed", options.seed, "Another seed gives independent noise");
  command->add_flag("--layers", options.layers, "Also write each object's diffuse, specular and coverage (.exr)");
  command->add_option("-o,--output", options.output, "Picture to write: .exr (linear) or .png (sRGB)")->required()->check(kNotEmpty);
  add_common_options(*command, options.common);
  command->footer("Example: vitrine render shop --at view=0.5,lamp=#2 --spp 64 -o look.png");
}

void add_compile(CLI::App& app, CompileCommand& options) {
  CLI::App* command = app.add_subcommand("compile", "Trace, infer, encode and link a scene into an image");
  command->add_option("SCENE", options.scene, "Folder with scene.toml, or a .toml file")->required()->check(kNotEmpty);
  command->add_option("-o,--output", options.image, "Image to write (.vit)")->required()->check(kNotEmpty);
  command->add_option("--preset", options.preset, "tiny (a look), small (a demo), full (as the scene says)")->capture_default_str()->check(CLI::IsMember({"tiny", "small", "full"}));
  command->add_option("--profile", options.profile, "Target profile instead of the scene's: a built-in name or a file")->check(kNotEmpty);
  command->add_option("--storage", options.storage, "Storage instead of the scene's: \"100:1\", \"150 KB/block\", \"12 MB\"")->check(kNotEmpty);
  command->add_option("--codec", options.codec, "How textures are coded, instead of the scene's: dct decodes fastest, spiht is embedded")->check(CLI::IsMember({"dct", "spiht"}));
  command->add_option("--work", options.work, "Folder for frames and textures; keep it to resume and recompile quickly (default: IMAGE.work)")->check(kNotEmpty);
  add_common_options(*command, options.common);
  command->footer("Example: vitrine compile shop -o lamp.vit --preset small");
}

void add_inspect(CLI::App& app, InspectCommand& options) {
  CLI::App* command = app.add_subcommand("inspect", "Print what an image holds");
  command->add_option("IMAGE", options.image, "Image (.vit)")->required()->check(kNotEmpty);
  command->add_option("--report", options.report, "Also write an HTML page: bytes by object, layer and level")->check(kNotEmpty);
  add_common_options(*command, options.common);
  command->footer("Example: vitrine inspect lamp.vit --json");
}

void add_verify(CLI::App& app, VerifyCommand& options) {
  CLI::App* command = app.add_subcommand("verify", "Play an image beside fresh ground truth and print PSNR");
  command->add_option("IMAGE", options.image, "Image (.vit)")->required()->check(kNotEmpty);
  command->add_option("--scene", options.scene, "The scene it was compiled from")->required()->check(kNotEmpty);
  command->add_option("--work", options.work, "Work folder of the compile (default: IMAGE.work); keeps references, and tells what inference alone gave")->check(kNotEmpty);
  command->add_option("--sheet", options.sheet, "Write a contact sheet (PNG): truth, playback, difference times 8")->check(kNotEmpty);
  command->add_option("--at", options.at, "References at grid samples")->capture_default_str()->check(CLI::Range(1, 1000));
  command->add_option("--between", options.between, "References half-way between samples of one axis")->capture_default_str()->check(CLI::Range(0, 1000));
  command->add_option("--off", options.off, "References off the samples of all axes")->capture_default_str()->check(CLI::Range(0, 1000));
  add_common_options(*command, options.common);
  command->footer("Example: vitrine verify lamp.vit --scene shop --json");
}

void add_bench_trace(CLI::App& bench, BenchTraceCommand& options) {
  CLI::App* command = bench.add_subcommand("trace", "The tracer's speed beside a bare loop of the same Embree queries");
  command->add_option("SCENE", options.scene, "Folder with scene.toml, or a .toml file")->required()->check(kNotEmpty);
  command->add_option("--spp", options.samples_per_pixel, "Camera rays per pixel")->capture_default_str()->check(CLI::Range(1, 64));
  add_common_options(*command, options.common);
  command->footer("Example: vitrine bench trace shop");
}

void add_bench_noise(CLI::App& bench, BenchNoiseCommand& options) {
  CLI::App* command = bench.add_subcommand("noise", "Noise that a preset leaves, layer by layer, and what the same costs with even sampling");
  command->add_option("SCENE", options.scene, "Folder with scene.toml, or a .toml file")->required()->check(kNotEmpty);
  command->add_option("--preset", options.preset, "Whose resolution and noise")->capture_default_str()->check(CLI::IsMember({"tiny", "small", "full"}));
  command->add_option("--size", options.size, "WIDTHxHEIGHT of other pictures than the preset's, to the same noise")->check(kNotEmpty);
  command->add_option("--views", options.views, "Grid samples along each axis that moves the camera alone; the other axes stay at their first")->capture_default_str()->check(CLI::Range(1, 64));
  command->add_option("--even", options.even, "Camera rays per pixel that even sampling starts with; 0: no comparison")->capture_default_str()->check(CLI::Range(0, 4096));
  command->add_flag("--frames-only", options.frames_only, "Infer no textures: frames as the whole preset has them");
  command->add_option("--work", options.work, "Folder for frames and textures (default: one that is removed afterwards)")->check(kNotEmpty);
  add_common_options(*command, options.common);
  command->footer("Example: vitrine bench noise shop --preset small --even 16");
}

void add_bench_inference(CLI::App& bench, BenchInferenceCommand& options) {
  CLI::App* command = bench.add_subcommand("inference", "Inferred textures beside forward-mapped and directly traced ones, through every filter, at the middle sample of all axes");
  command->add_option("SCENE", options.scene, "Folder with scene.toml, or a .toml file")->required()->check(kNotEmpty);
  command->add_option("--object", options.object, "The only object to measure (default: all that are drawn)")->check(kNotEmpty);
  command->add_option("--size", options.size, "WIDTHxHEIGHT instead of the scene's")->check(kNotEmpty);
  command->add_option("--spp", options.samples_per_pixel, "Camera rays of every pixel, and rays of every texel that is traced directly")->capture_default_str()->check(CLI::Range(1, 1 << 16));
  command->add_flag("--matrices", options.matrices, "Also read the rendering matrix in every way there is, which takes minutes, and compare cost and result");
  command->add_option("--sheet", options.sheet, "Write a contact sheet (PNG): truth and the three methods, trilinear and with 4 taps")->check(kNotEmpty);
  command->add_option("--textures", options.textures, "Write the inferred textures (PNG): what pixels determine, and with what regularization fills in")->check(kNotEmpty);
  add_common_options(*command, options.common);
  command->footer("Example: vitrine bench inference shop --size 320x240 --sheet methods.png");
}

void add_bench_coordinates(CLI::App& bench, BenchCoordinatesCommand& options) {
  CLI::App* command = bench.add_subcommand("coordinates", "Texels that fitted texture coordinates save, object by object, in a block of views");
  command->add_option("SCENE", options.scene, "Folder with scene.toml, or a .toml file")->required()->check(kNotEmpty);
  command->add_option("--size", options.size, "WIDTHxHEIGHT instead of the scene's")->check(kNotEmpty);
  command->add_option("--views", options.views, "Samples in the middle of the axis that moves the camera")->capture_default_str()->check(CLI::Range(1, 64));
  command->add_option("--spp", options.samples_per_pixel, "Camera rays of every pixel")->capture_default_str()->check(CLI::Range(1, 1 << 16));
  command->add_option("--work", options.work, "Folder for frames and textures (default: one that is removed afterwards)")->check(kNotEmpty);
  add_common_options(*command, options.common);
  command->footer("Example: vitrine bench coordinates shop --size 320x240");
}

void add_bench_inference_cost(CLI::App& bench, BenchInferenceCostCommand& options) {
  CLI::App* command = bench.add_subcommand("inference-cost", "Processor time and memory of inference beside tracing, over samples and over pixels");
  command->add_option("SCENE", options.scene, "Folder with scene.toml, or a .toml file")->required()->check(kNotEmpty);
  command->add_option("--size", options.size, "WIDTHxHEIGHT instead of the scene's")->check(kNotEmpty);
  command->add_flag("--no-trace", options.no_trace, "Trace no frame as compiled, and give no share of it");
  command->add_flag("--no-scaling", options.no_scaling, "Leave out the rows over samples and over pixels");
  command->add_flag("--whole", options.whole, "Also infer all samples of the scene, from frames of few paths");
  command->add_option("--plot", options.plot, "Write the curves (SVG)")->check(kNotEmpty);
  command->add_option("--work", options.work, "Folder for frames and textures (default: one that is removed afterwards)")->check(kNotEmpty);
  add_common_options(*command, options.common);
  command->footer("Example: vitrine bench inference-cost shop --plot cost.svg");
}

void add_bench_compression(CLI::App& bench, BenchCompressionCommand& options) {
  CLI::App* command = bench.add_subcommand("compression", "Textures as Vitrine codes them beside today's video coders, of the pictures and of the textures");
  command->add_option("SCENE", options.scene, "Folder with scene.toml, or a .toml file")->required()->check(kNotEmpty);
  command->add_option("--size", options.size, "WIDTHxHEIGHT instead of the scene's")->check(kNotEmpty);
  command->add_option("--samples", options.samples, "Samples in the middle of every axis; 0: all")->capture_default_str()->check(CLI::Range(0, 1024));
  command->add_option("--noise", options.noise_db, "What frames are traced to, in decibels, instead of the scene's")->check(CLI::Range(10, 80));
  command->add_option("--ratios", options.ratios, "Raw bytes of the pictures over coded ones, separated by commas (default: 384,768)")->delimiter(',')->check(CLI::Range(1.0, 1e6));
  command->add_flag("--frames-only", options.frames_only, "Trace what --work lacks, and stop");
  command->add_option("--coders", options.coders, "The only video coders, separated by commas")->delimiter(',')->check(CLI::IsMember({"x264", "x265", "svt-av1", "mpeg4"}));
  command->add_flag("--no-videos", options.no_videos, "Leave out the video coders, which take most of the time, and ffmpeg");
  command->add_option("--page", options.page, "Also write an HTML page: tables, plots and close-ups")->check(kNotEmpty);
  command->add_option("--work", options.work, "Folder for frames and textures; keep it to resume (default: one that is removed afterwards)")->check(kNotEmpty);
  add_common_options(*command, options.common);
  command->footer("Example: vitrine bench compression shop --size 320x240 --noise 36 --work shop.work");
}

void add_bench_allocation(CLI::App& bench, BenchAllocationCommand& options) {
  CLI::App* command = bench.add_subcommand("allocation", "Error over bytes of every object's layers, and how steep each curve is where the storage is shared out");
  command->add_option("SCENE", options.scene, "Folder with scene.toml, or a .toml file")->required()->check(kNotEmpty);
  command->add_option("--preset", options.preset, "As in compile")->capture_default_str()->check(CLI::IsMember({"tiny", "small", "full"}));
  command->add_option("--storage", options.storage, "What textures alone take, instead of the scene's storage: \"100:1\", \"150 KB/block\", \"12 MB\"")->check(kNotEmpty);
  command->add_option("--plot", options.plot, "Write the curves (SVG)")->check(kNotEmpty);
  command->add_option("--work", options.work, "Folder for frames and textures (default: one that is removed afterwards)")->check(kNotEmpty);
  add_common_options(*command, options.common);
  command->footer("Example: vitrine bench allocation shop --storage 384:1 --work shop.work --plot allocation.svg");
}

void add_bench_smoothing(CLI::App& bench, BenchSmoothingCommand& options) {
  CLI::App* command = bench.add_subcommand("smoothing", "What smoothing textures over the axes takes from the samples and gives between them, in images of one size");
  command->add_option("SCENE", options.scene, "Folder with scene.toml, or a .toml file")->required()->check(kNotEmpty);
  command->add_option("--preset", options.preset, "As in compile")->capture_default_str()->check(CLI::IsMember({"tiny", "small", "full"}));
  command->add_option("--work", options.work, "Folder for frames and textures (default: one that is removed afterwards)")->check(kNotEmpty);
  add_common_options(*command, options.common);
  command->footer("Example: vitrine bench smoothing shop --work shop.work");
}

void add_bench_decode(CLI::App& bench, BenchDecodeCommand& options) {
  CLI::App* command = bench.add_subcommand("decode", "How fast one thread decodes an image's nodes, beside libjpeg-turbo with the same pictures at equal PSNR and a plain copy");
  command->add_option("IMAGE", options.image, "Image (.vit)")->required()->check(kNotEmpty);
  command->add_option("--scene", options.scene, "The scene it was compiled from")->required()->check(kNotEmpty);
  command->add_option("--work", options.work, "Work folder of the compile (default: IMAGE.work)")->check(kNotEmpty);
  command->add_option("--rounds", options.rounds, "Rounds, of which the best counts")->capture_default_str()->check(CLI::Range(1, 1000));
  add_common_options(*command, options.common);
  command->footer("Example: vitrine bench decode lamp.vit --scene shop");
}

std::string name_of_command(const CLI::App& app) {
  const std::vector<CLI::App*> commands = app.get_subcommands();
  return commands.empty() ? "vitrine" : "vitrine " + commands.front()->get_name();
}

bool has_command(const CLI::App& app, const std::string& name) {
  const std::vector<const CLI::App*> all = app.get_subcommands([](const CLI::App*) { return true; });
  return std::any_of(all.begin(), all.end(), [&](const CLI::App* command) { return command->get_name() == name; });
}

struct Commands {
  NewCommand create;
  RenderCommand render;
  CompileCommand compile;
  InspectCommand inspect;
  VerifyCommand verify;
  BenchTraceCommand bench_trace;
  BenchNoiseCommand bench_noise;
  BenchInferenceCommand bench_inference;
  BenchCoordinatesCommand bench_coordinates;
  BenchInferenceCostCommand bench_inference_cost;
  BenchAllocationCommand bench_allocation;
  BenchSmoothingCommand bench_smoothing;
  BenchDecodeCommand bench_decode;
  BenchCompressionCommand bench_compression;
};

std::function<void()> chosen(const CLI::App& app, const Commands& commands) {
  if (app.got_subcommand("new")) return [command = commands.create] { command.run(); };
  if (app.got_subcommand("render")) return [command = commands.render] { command.run(); };
  if (app.got_subcommand("compile")) return [command = commands.compile] { command.run(); };
  if (app.got_subcommand("inspect")) return [command = commands.inspect] { command.run(); };
  if (app.got_subcommand("verify")) return [command = commands.verify] { command.run(); };
  if (app.get_subcommand("bench")->got_subcommand("noise")) return [command = commands.bench_noise] { command.run(); };
  if (app.get_subcommand("bench")->got_subcommand("inference")) return [command = commands.bench_inference] { command.run(); };
  if (app.get_subcommand("bench")->got_subcommand("coordinates")) return [command = commands.bench_coordinates] { command.run(); };
  if (app.get_subcommand("bench")->got_subcommand("inference-cost")) return [command = commands.bench_inference_cost] { command.run(); };
  if (app.get_subcommand("bench")->got_subcommand("compression")) return [command = commands.bench_compression] { command.run(); };
  if (app.get_subcommand("bench")->got_subcommand("allocation")) return [command = commands.bench_allocation] { command.run(); };
  if (app.get_subcommand("bench")->got_subcommand("smoothing")) return [command = commands.bench_smoothing] { command.run(); };
  if (app.get_subcommand("bench")->got_subcommand("decode")) return [command = commands.bench_decode] { command.run(); };
  return [command = commands.bench_trace] { command.run(); };
}

}  // namespace

std::function<void()> parse_command_line(int argc, char** argv) {
  CLI::App app{"Vitrine compiles a scene with dials into an image that a small engine plays."};
  app.set_version_flag("--version", "vitrine " VITRINE_VERSION);
  app.require_subcommand(1);
  app.footer("Example: vitrine new shop --from lamp.glb && vitrine compile shop -o lamp.vit --preset small && vitrine-play lamp.vit");
  Commands commands;
  add_new(app, commands.create);
  add_render(app, commands.render);
  add_compile(app, commands.compile);
  add_inspect(app, commands.inspect);
  add_verify(app, commands.verify);
  CLI::App* bench = app.add_subcommand("bench", "Measure a stage against its peers; each prints a table");
  bench->require_subcommand(1);
  bench->footer("Example: vitrine bench trace shop");
  add_bench_trace(*bench, commands.bench_trace);
  add_bench_noise(*bench, commands.bench_noise);
  add_bench_inference(*bench, commands.bench_inference);
  add_bench_coordinates(*bench, commands.bench_coordinates);
  add_bench_inference_cost(*bench, commands.bench_inference_cost);
  add_bench_compression(*bench, commands.bench_compression);
  add_bench_allocation(*bench, commands.bench_allocation);
  add_bench_smoothing(*bench, commands.bench_smoothing);
  add_bench_decode(*bench, commands.bench_decode);
  // CLI11 would only say that a subcommand is missing.
  if (argc > 1 && argv[1][0] != '-' && !has_command(app, argv[1]))
    throw UsageError(std::string("there is no command \"") + argv[1] + "\": use new, render, compile, inspect, verify or bench: see vitrine --help");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked) {
    app.exit(asked);
    return {};
  } catch (const CLI::ParseError& error) {
    throw UsageError(std::string(error.what()) + ": see " + name_of_command(app) + " --help");
  }
  return chosen(app, commands);
}

}  // namespace vitrine
