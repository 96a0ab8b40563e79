// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host/base/output_file.h"
#include "host/bench/allocation_costs.h"
#include "host/compile/compile.h"
#include "host/compile/preset.h"
#include "tools/commands/commands.h"
#include "tools/commands/html.h"
#include "tools/commands/print_json.h"
#include "tools/commands/scene_input.h"
#include "tools/commands/work_folder.h"

namespace vitrine {
namespace {

std::vector<FieldLabel> labels_of(const Scene& scene, const Inference& inference) {
  std::vector<FieldLabel> labels;
  for (const Field& field : inference.fields) {
    const DrawnObject& drawn = inference.objects[static_cast<size_t>(field.drawn_object)];
    labels.push_back({scene.objects[static_cast<size_t>(drawn.object)].name, field.layer});
  }
  return labels;
}

nlohmann::json json_of(const Allocation& allocation) {
  nlohmann::json rows = nlohmann::json::array();
  for (const FieldAllocation& field : allocation.fields) {
    nlohmann::json curve = nlohmann::json::array();
    for (size_t p = 0; p < field.curve.size(); ++p)
      curve.push_back({{"price", kAllocationPrices[p] * allocation.price},
                       {"bytes", field.curve[p].bytes},
                       {"squared_error", field.curve[p].squared_error}});
    rows.push_back({{"object", field.object}, {"layer", field.layer}, {"curve", curve}, {"slope", slope_of(field.curve)}});
  }
  return {{"bench", "allocation"}, {"price", allocation.price}, {"slope", slope_of(allocation.all())}, {"rows", rows}};
}

void print_allocation(const Allocation& allocation) {
  const AllocationCurve sums = allocation.all();
  const auto print_row = [&](const std::string& object, const std::string& layer, const AllocationCurve& curve) {
    const double slope = slope_of(curve);
    fmt::print("{:<16} {:<9} {:>8.0f} {:>8.1f} {:>8.1f} {:>13.2f} {:>14.2f}\n", object, layer, curve[kChosenPrice].bytes,
               100 * curve[kChosenPrice].bytes / sums[kChosenPrice].bytes,
               100 * curve[kChosenPrice].squared_error / sums[kChosenPrice].squared_error, slope / allocation.price,
               slope / slope_of(sums));
  };
  fmt::print("{:<16} {:<9} {:>8} {:>8} {:>8} {:>13} {:>14}\n", "object", "layer", "bytes", "bytes, %", "error, %",
             "slope / price", "slope / of all");
  for (const FieldAllocation& field : allocation.fields) print_row(field.object, field.layer, field.curve);
  print_row("all", "", sums);
}

void write_plot(const std::string& file, Allocation allocation) {
  for (FieldAllocation& field : allocation.fields) field.object = html_escaped(field.object);
  write_page(file, plot_of(allocation));
}

}  // namespace

void BenchAllocationCommand::run() const {
  if (!plot.empty()) check_output_file(plot);
  const auto jobs = limit_jobs(common);
  const auto progress = make_progress(common);
  const auto loaded = load_scene_with(scene, common, [&](Scene& s) { apply_preset(s, preset); });
  const uint64_t bytes = storage.empty() ? storage_bytes(loaded->settings.storage, *loaded, loaded->file.string())
                                         : storage_bytes(storage, *loaded, "--storage");
  const Profile profile = load_profile(loaded->settings.profile, loaded->file.string() + ": target.profile");
  const WorkFolder folder(work);
  const Store store(folder.path());
  trace_missing(*loaded, store, *progress);
  const auto inference = find_inference(*loaded, store, profile.supersampling, profile.filter, *progress);
  const Allocation allocation = measure_allocation(field_sources(*loaded, *inference, store), labels_of(*loaded, *inference),
                                                   loaded->settings.codec, static_cast<double>(bytes), *progress);
  if (!plot.empty()) write_plot(plot, allocation);
  if (common.json) return print_json(json_of(allocation));
  print_allocation(allocation);
}

}  // namespace vitrine
