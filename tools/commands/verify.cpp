// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "host/base/output_file.h"
#include "host/compile/compile.h"
#include "host/verify/verify.h"
#include "tools/commands/commands.h"
#include "tools/commands/print_json.h"
#include "tools/commands/contact_sheet.h"
#include "tools/commands/image_input.h"
#include "tools/commands/scene_input.h"

namespace vitrine {
namespace {

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

// A figure is about the image only while its references are much cleaner than it.
void warn_of_noise(const Verification& verification) {
  constexpr double kMarginDb = 6;
  for (const Comparison& comparison : verification.comparisons)
    if (psnr_db(comparison.noise) < psnr_db(comparison.squared_error) + kMarginDb)
      fmt::print(stderr, "vitrine: warning: a reference of \"{}\" kept noise of {:.2f} dB after {} paths per pixel, less than {} dB below the error: the image may be better than its figure\n",
                 comparison.kind, psnr_db(comparison.noise), comparison.paths_per_pixel, kMarginDb);
}

}  // namespace

void VerifyCommand::run() const {
  if (!sheet.empty()) check_output_file(sheet);
  const auto jobs = limit_jobs(common);
  const auto progress = make_progress(common);
  const OpenImage opened(image);
  const auto loaded = load_scene_of(opened.view(), image, scene, common);

  const Store store(work.empty() ? default_work_folder(image) : std::filesystem::path(work));
  const auto inference = find_inference(*loaded, store, static_cast<int>(opened.view().directory().supersampling()),
                                        opened.view().filter(), *progress);
  const Verification verification = verify_image(opened.view(), *loaded, store, inference ? &*inference : nullptr, {.at = at, .between = between, .off = off}, *progress);
  if (!common.quiet) warn_of_noise(verification);
  if (!sheet.empty()) write_contact_sheet(sheet, verification.comparisons);
  if (common.json)
    print_json(report_json(verification, inference.has_value()));
  else
    print_text(verification, inference.has_value());
}

}  // namespace vitrine
