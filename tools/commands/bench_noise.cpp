// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/bench/noise_costs.h"
#include "host/compile/compile.h"
#include "host/compile/preset.h"
#include "host/infer/fields.h"
#include "tools/commands/commands.h"
#include "tools/commands/print_json.h"
#include "tools/commands/scene_input.h"
#include "tools/commands/work_folder.h"

namespace vitrine {
namespace {

void keep_views(Scene& scene, int views) {
  const AxisMask camera = only_camera_axes(scene);
  for (size_t a = 0; a < scene.axes.size(); ++a) scene.axes[a].shape.samples = std::min(scene.axes[a].shape.samples, camera >> a & 1 ? views : 1);
}

struct Row {
  std::string sampling;
  NoiseCost cost;
};

nlohmann::json json_of(const Row& row) {
  nlohmann::json layers = nlohmann::json::array();
  for (const LayerCost& l : row.cost.layers) {
    layers.push_back({{"object", l.object}, {"layer", l.layer}, {"estimated_db", l.estimated_db}, {"frame_db", l.frame_db}});
    layers.back()["inferred_db"] = l.inferred_db ? nlohmann::json(*l.inferred_db) : nlohmann::json();
  }
  nlohmann::json drawn = nlohmann::json::object();
  for (const DrawnCost& d : row.cost.drawn) drawn[d.object] = d.db;
  return {{"sampling", row.sampling}, {"rays_per_pixel", row.cost.rays_per_pixel}, {"seconds_per_frame", row.cost.seconds},
          {"worst_db", row.cost.worst_db}, {"picture_db", row.cost.picture_db}, {"layers", layers}, {"drawn_db", drawn}};
}

void print_row(const Row& row) {
  const NoiseCost& c = row.cost;
  fmt::print("{}: {:.1f} camera rays a pixel, {:.2f} s of processor time a frame", row.sampling, c.rays_per_pixel, c.seconds);
  fmt::print("\n  {:<24} {:<9} {:>12} {:>10} {:>10}\n", "between two seeds, dB", "by layer:", "estimated", "in frames",
             "inferred");
  for (const LayerCost& l : c.layers) {
    const std::string inferred = l.inferred_db ? fmt::format("{:.2f}", *l.inferred_db) : "-";
    fmt::print("  {:<24} {:<9} {:>12.2f} {:>10.2f} {:>10}\n", l.object, l.layer, l.estimated_db, l.frame_db, inferred);
  }
  if (c.drawn.empty()) return;
  fmt::print("  drawn with textures:");
  for (const DrawnCost& d : c.drawn) fmt::print(" {} {:.2f}", d.object, d.db);
  fmt::print(", whole pictures {:.2f}\n", c.picture_db);
}

// How many times the processor time of `by_need` even sampling takes for the same error: variance falls with the rays.
double times_cheaper(const NoiseCost& even, const NoiseCost& by_need, double even_db, double by_need_db) {
  return even.seconds / by_need.seconds * std::pow(10, (by_need_db - even_db) / 10);
}

}  // namespace

void BenchNoiseCommand::run() const {
  const auto jobs = limit_jobs(common);
  const auto progress = make_progress(common);
  int averaged = 1;
  const auto loaded = load_scene_with(scene, common, [&](Scene& s) {
    apply_preset(s, preset);
    apply_size(s, size);
    averaged = trace_options(s).views;
    keep_views(s, views);
  });
  const WorkFolder folder(work);
  const Store store(folder.path());
  TraceOptions options = trace_options(*loaded);
  // Frames by themselves are those of the whole preset; textures are averaged over the views that there are here.
  options.views = frames_only ? averaged : std::min(averaged, views);
  std::vector<Row> rows;
  rows.push_back({"by need", measure_noise(*loaded, options, !frames_only, store, *progress)});
  if (even > 0) {
    options.noise_db = 0;
    options.samples_per_pixel = even;
    rows.push_back({"even", measure_noise(*loaded, options, !frames_only, store, *progress)});
    // Again with as many rays as should leave the worst object the same error.
    const double missing = rows[0].cost.worst_db - rows[1].cost.worst_db;
    options.samples_per_pixel = std::max(1, static_cast<int>(std::lround(even * std::pow(10, missing / 10))));
    if (!frames_only) rows.push_back({"even", measure_noise(*loaded, options, true, store, *progress)});
  }
  nlohmann::json report = {{"bench", "noise"}, {"rows", nlohmann::json::array()}};
  for (const Row& row : rows) report["rows"].push_back(json_of(row));
  if (rows.size() == 3) {
    const NoiseCost &by_need = rows[0].cost, &same = rows[2].cost;
    report["times_cheaper_worst_object"] = times_cheaper(same, by_need, same.worst_db, by_need.worst_db);
    report["times_cheaper_picture"] = times_cheaper(same, by_need, same.picture_db, by_need.picture_db);
  }
  if (common.json) return print_json(report);
  for (const Row& row : rows) print_row(row);
  if (rows.size() == 3)
    fmt::print("even sampling takes {:.2f} times as long for the same error of the worst object, {:.2f} times for that of the pictures\n",
               report["times_cheaper_worst_object"].get<double>(), report["times_cheaper_picture"].get<double>());
}

}  // namespace vitrine
