// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "hal/backends.h"
#include "hal/storage.h"
#include "host/base/error.h"
#include "host/compile/compile.h"
#include "host/compile/preset.h"
#include "host/verify/verify.h"
#include "tools/commands/commands.h"
#include "tools/commands/contact_sheet.h"
#include "tools/commands/scene_input.h"

namespace vitrine {
namespace {

struct Options {
  std::string image, scene, work, sheet;
  VerifyOptions verify;
  CommonOptions common;
};

// Comparisons of one kind, taken together.
struct Summary {
  double squared_error = 0, noise = 0, inferred = 0;
  int count = 0;
  std::map<std::string, ObjectError> objects, inferred_objects;
  double psnr() const { return psnr_db(squared_error / count); }
  double noise_psnr() const { return psnr_db(noise / count); }
};

void add_errors(const std::vector<ObjectError>& errors, std::map<std::string, ObjectError>& sums) {
  for (const ObjectError& object : errors) {
    ObjectError& sum = sums[object.name];
    sum.squared_error += object.squared_error;
    sum.values += object.values;
  }
}

Summary summarize(const Verification& verification, const std::string& kind) {
  Summary summary;
  for (const Comparison& comparison : verification.comparisons) {
    if (comparison.kind != kind) continue;
    ++summary.count;
    summary.squared_error += comparison.squared_error;
    summary.noise += comparison.noise;
    summary.inferred += comparison.inferred_squared_error;
    add_errors(comparison.objects, summary.objects);
    add_errors(comparison.inferred_objects, summary.inferred_objects);
  }
  return summary;
}

double object_psnr(const ObjectError& error) { return psnr_db(error.squared_error / static_cast<double>(error.values)); }

std::string worst_object(const Summary& summary) {
  std::string worst;
  for (const auto& [name, error] : summary.objects)
    if (worst.empty() || object_psnr(error) < object_psnr(summary.objects.at(worst))) worst = name;
  return worst;
}

nlohmann::json psnr_of_objects(const std::map<std::string, ObjectError>& errors) {
  nlohmann::json objects = nlohmann::json::object();
  for (const auto& [name, error] : errors) objects[name] = object_psnr(error);
  return objects;
}

nlohmann::json summary_json(const Summary& summary) {
  const nlohmann::json objects = psnr_of_objects(summary.objects);
  const std::string worst = worst_object(summary);
  return {{"psnr_db", summary.psnr()}, {"noise_psnr_db", summary.noise_psnr()}, {"references", summary.count}, {"objects", objects},
          {"worst_object", {{"name", worst}, {"psnr_db", worst.empty() ? 99.0 : object_psnr(summary.objects.at(worst))}}}};
}

void print_text(const Verification& verification, bool with_inferred) {
  for (const char* kind : {"at", "between", "off"}) {
    const Summary summary = summarize(verification, kind);
    if (summary.count == 0) continue;
    fmt::print("{:8} {:6.2f} dB  (noise of {} references: {:.2f} dB)", kind, summary.psnr(), summary.count, summary.noise_psnr());
    for (const auto& [name, error] : summary.objects) fmt::print("  {} {:.2f}", name, object_psnr(error));
    fmt::print("\n");
    if (!with_inferred || std::string(kind) != "at") continue;
    fmt::print("         {:6.2f} dB  inference alone, before coding:", psnr_db(summary.inferred / summary.count));
    for (const auto& [name, error] : summary.inferred_objects) fmt::print("  {} {:.2f}", name, object_psnr(error));
    fmt::print("\n");
  }
  fmt::print("bytes {}  raw {}  ratio {:.1f}:1\n", verification.bytes, verification.raw_bytes,
             static_cast<double>(verification.raw_bytes) / static_cast<double>(verification.bytes));
}

nlohmann::json report_json(const Verification& verification, bool with_inferred) {
  nlohmann::json report = {{"bytes", verification.bytes}, {"raw_bytes", verification.raw_bytes},
                           {"ratio", static_cast<double>(verification.raw_bytes) / static_cast<double>(verification.bytes)}};
  for (const char* kind : {"at", "between", "off"}) {
    const Summary summary = summarize(verification, kind);
    if (summary.count > 0) report[kind] = summary_json(summary);
    if (with_inferred && std::string(kind) == "at" && summary.count > 0)
      report["inference_only"] = {{"psnr_db", psnr_db(summary.inferred / summary.count)}, {"objects", psnr_of_objects(summary.inferred_objects)}};
  }
  return report;
}

GridOfImage grid_of(const ImageView& image) {
  GridOfImage grid;
  grid.width = static_cast<int>(image.directory().width());
  grid.height = static_cast<int>(image.directory().height());
  grid.paths_per_pixel = static_cast<int>(image.directory().paths_per_pixel());
  for (const fb::Axis* axis : *image.directory().axes()) grid.axes.emplace_back(axis->name()->str(), static_cast<int>(axis->samples()));
  return grid;
}

// Axes may well be called alike in two scenes; objects hardly are.
void check_objects(const ImageView& image, const Scene& scene, const std::string& name) {
  for (const fb::Object* object : *image.directory().objects())
    if (std::none_of(scene.objects.begin(), scene.objects.end(), [&](const Object& o) { return o.name == object->name()->str(); }))
      throw InputError(name, "it shows \"" + object->name()->str() + "\", which " + scene.file.string() + " does not have", "name the scene that it was compiled from");
}

void run(const Options& options) {
  const auto jobs = limit_jobs(options.common);
  const auto progress = make_progress(options.common);
  auto file = hal::MappedFile::open(options.image.c_str());
  if (!file.ok()) throw InputError(options.image, file.status().detail(), "name an image that vitrine compile wrote");
  const auto image = ImageView::open(file.value().bytes());
  if (!image.ok()) throw InputError(options.image, image.status().detail(), "compile it again");
  const auto scene = load_scene_with(options.scene, options.common, [&](Scene& s) { apply_grid(s, grid_of(image.value()), options.image); });
  check_objects(image.value(), *scene, options.image);

  const Store store(options.work.empty() ? default_work_folder(options.image) : std::filesystem::path(options.work));
  const auto inference = find_inference(*scene, store, static_cast<int>(image.value().directory().supersampling()), *progress);
  const Verification verification = verify_image(image.value(), *scene, store, inference ? &*inference : nullptr, options.verify, *progress);
  if (!options.sheet.empty()) write_contact_sheet(options.sheet, verification.comparisons);
  if (options.common.json)
    fmt::print("{}\n", report_json(verification, inference.has_value()).dump());
  else
    print_text(verification, inference.has_value());
}

}  // namespace

void add_verify_command(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("verify", "Play an image beside fresh ground truth and print PSNR");
  command->add_option("IMAGE", options->image, "Image (.vit)")->required();
  command->add_option("--scene", options->scene, "The scene it was compiled from")->required();
  command->add_option("--work", options->work, "Work folder of the compile (default: IMAGE.work); keeps references, and tells what inference alone gave");
  command->add_option("--sheet", options->sheet, "Write a contact sheet (PNG): truth, playback, difference times 8");
  command->add_option("--at", options->verify.at, "References at grid samples")->capture_default_str()->check(CLI::Range(1, 1000));
  command->add_option("--between", options->verify.between, "References half-way between samples of one axis")->capture_default_str()->check(CLI::Range(0, 1000));
  command->add_option("--off", options->verify.off, "References off the samples of all axes")->capture_default_str()->check(CLI::Range(0, 1000));
  add_common_options(*command, options->common);
  command->footer("Example: vitrine verify lamp.vit --scene shop --json");
  command->callback([options] { run(*options); });
}

}  // namespace vitrine
