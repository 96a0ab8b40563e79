// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host/base/output_file.h"
#include "host/bench/inference_cost.h"
#include "host/compile/compile.h"
#include "host/compile/preset.h"
#include "tools/commands/commands.h"
#include "tools/commands/html.h"
#include "tools/commands/print_json.h"
#include "tools/commands/scene_input.h"
#include "tools/commands/work_folder.h"

namespace vitrine {
namespace {

nlohmann::json json_of(const char* over, const InferenceCostRow& row) {
  return {{"over", over},
          {"samples", row.samples},
          {"width", row.width},
          {"height", row.height},
          {"texels", row.texels},
          {"seconds", row.seconds.total()},
          {"survey_seconds", row.seconds.survey},
          {"choose_reader_seconds", row.seconds.choose_reader},
          {"read_matrices_seconds", row.seconds.read_matrices},
          {"solve_seconds", row.seconds.solve}};
}

// What a further sample costs: without the start that all share.
double marginal(const InferenceCostRow& row) { return row.seconds.total() - row.seconds.choose_reader; }

nlohmann::json json_of(const InferenceCost& cost) {
  nlohmann::json rows = nlohmann::json::array({json_of("sample", cost.sample)});
  for (const InferenceCostRow& row : cost.by_samples) rows.push_back(json_of("samples", row));
  for (const InferenceCostRow& row : cost.by_pixels) rows.push_back(json_of("pixels", row));
  for (const InferenceCostRow& row : cost.whole) rows.push_back(json_of("whole", row));
  nlohmann::json report = {{"bench", "inference-cost"}, {"rows", rows}, {"peak_bytes", cost.peak_bytes}};
  if (cost.trace_seconds > 0) {
    report["trace_seconds"] = cost.trace_seconds;
    report["ratio"] = marginal(cost.sample) / cost.trace_seconds;
  }
  if (!cost.by_samples.empty()) {
    report["samples_exponent"] = cost.samples_exponent;
    report["pixels_exponent"] = cost.pixels_exponent;
  }
  return report;
}

void print_row(const InferenceCostRow& row) {
  const InferenceSeconds& s = row.seconds;
  fmt::print("  {:>7} {:>5} x {:<5} {:>9} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.2f}\n", row.samples, row.width, row.height,
             row.texels, s.survey, s.read_matrices, s.solve, marginal(row), s.choose_reader);
}

void print_rows(const char* title, const std::vector<InferenceCostRow>& rows) {
  if (rows.empty()) return;
  fmt::print("{}\n  {:>7} {:>13} {:>9} {:>8} {:>8} {:>8} {:>8} {:>8}\n", title, "samples", "pixels", "texels", "survey",
             "matrices", "solve", "sum", "start");
  for (const InferenceCostRow& row : rows) print_row(row);
}

void print_cost(const InferenceCost& cost) {
  fmt::print("processor seconds; \"start\", once in a compile, chooses the reader of matrices\n");
  print_rows("one sample", {cost.sample});
  if (cost.trace_seconds > 0)
    fmt::print("tracing its frame takes {:.1f} s, inferring its textures {:.2f} s: {:.1f} %\n", cost.trace_seconds,
               marginal(cost.sample), 100 * marginal(cost.sample) / cost.trace_seconds);
  print_rows("over samples", cost.by_samples);
  if (!cost.by_samples.empty()) fmt::print("cost grows as samples to the power of {:.2f}\n", cost.samples_exponent);
  print_rows("over pixels", cost.by_pixels);
  if (!cost.by_pixels.empty()) fmt::print("cost grows as pixels to the power of {:.2f}\n", cost.pixels_exponent);
  print_rows("the whole grid", cost.whole);
  fmt::print("most memory at once: {:.0f} MiB\n", static_cast<double>(cost.peak_bytes) / (1 << 20));
}

}  // namespace

void BenchInferenceCostCommand::run() const {
  if (!plot.empty()) check_output_file(plot);
  const auto jobs = limit_jobs(common);
  const auto progress = make_progress(common);
  const auto loaded = load_scene_with(scene, common, [&](Scene& s) {
    apply_preset(s, "full");
    apply_size(s, size);
  });
  const WorkFolder folder(work);
  const InferenceCost cost =
      measure_inference_cost(*loaded, trace_options(*loaded), {.trace = !no_trace, .scaling = !no_scaling, .whole_grid = whole},
                             folder.path() / "inference-cost", *progress);
  if (!plot.empty()) write_page(plot, plot_of(cost));
  if (common.json) return print_json(json_of(cost));
  print_cost(cost);
}

}  // namespace vitrine
