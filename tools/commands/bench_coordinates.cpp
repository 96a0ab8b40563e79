// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host/bench/coordinate_costs.h"
#include "tools/commands/commands.h"
#include "tools/commands/print_json.h"
#include "tools/commands/scene_input.h"
#include "tools/commands/work_folder.h"

namespace vitrine {
namespace {

nlohmann::json json_of(const std::vector<TexelPoint>& points) {
  nlohmann::json list = nlohmann::json::array();
  for (const TexelPoint& p : points) list.push_back({{"texels", p.texels}, {"psnr_db", p.psnr_db}});
  return list;
}

nlohmann::json json_of(const CoordinateCost& cost) {
  nlohmann::json row = {{"object", cost.object},
                        {"coordinates", cost.artists ? "artist" : "charts"},
                        {"psnr_db", cost.compared.psnr_db},
                        {"texels", cost.compared.texels},
                        {"fitted", json_of(cost.fitted)},
                        {"whole", json_of(cost.whole)}};
  row["texels_whole"] = cost.texels_needed ? nlohmann::json(*cost.texels_needed) : nlohmann::json();
  row["ratio"] = cost.texels_needed ? nlohmann::json(cost.compared.texels / *cost.texels_needed) : nlohmann::json();
  return row;
}

void print_cost(const CoordinateCost& cost) {
  const bool reached = cost.texels_needed.has_value();
  const double whole = reached ? *cost.texels_needed : cost.whole.back().texels;
  fmt::print("{:<16} {:<8} {:>8.2f} {:>10.0f} {:>2}{:>10.0f} {:>2}{:>6.1f} %\n", cost.object, cost.artists ? "artist" : "charts",
             cost.compared.psnr_db, cost.compared.texels, reached ? "" : ">", whole, reached ? "" : "<",
             100 * cost.compared.texels / whole);
}

}  // namespace

void BenchCoordinatesCommand::run() const {
  const auto jobs = limit_jobs(common);
  const auto progress = make_progress(common);
  const auto loaded = load_scene_with(scene, common, [&](Scene& s) { apply_size(s, size); });
  const WorkFolder folder(work);
  const auto costs = measure_coordinates(*loaded, views, samples_per_pixel, Store(folder.path()), *progress);
  if (common.json) {
    nlohmann::json rows = nlohmann::json::array();
    for (const CoordinateCost& cost : costs) rows.push_back(json_of(cost));
    return print_json({{"bench", "coordinates"}, {"rows", rows}});
  }
  fmt::print("texels of a sample with fitted texture coordinates, and with the mesh's own for the same PSNR\n");
  fmt::print("{:<16} {:<8} {:>8} {:>10} {:>12} {:>9}\n", "object", "mesh's", "PSNR, dB", "fitted", "mesh's own", "share");
  for (const CoordinateCost& cost : costs) print_cost(cost);
}

}  // namespace vitrine
