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
  return {{"object", cost.object},
          {"coordinates", cost.artists ? "artist" : "charts"},
          {"psnr_db", cost.compared.psnr_db},
          {"texels", cost.compared.texels},
          {"texels_whole", json_or_null(cost.whole_needs)},
          {"texels_square", json_or_null(cost.square_needs)},
          {"fitted", json_of(cost.fitted)},
          {"whole", json_of(cost.whole)},
          {"square", json_of(cost.square)}};
}

// What the mesh's own coordinates need, and the share of it that fitted ones do.
std::string needs(double fitted, const std::optional<double>& own, const std::vector<TexelPoint>& points) {
  const double texels = own ? *own : points.back().texels;
  return fmt::format("{:>1}{:>9.0f} {:>1}{:>5.1f} %", own ? "" : ">", texels, own ? "" : "<", 100 * fitted / texels);
}

void print_costs(const std::vector<CoordinateCost>& costs) {
  fmt::print("texels of a sample with fitted texture coordinates, and with the mesh's own for the same PSNR\n");
  fmt::print("{:<16} {:<8} {:>8} {:>10}   {:<19}   {:<19}\n", "object", "mesh's", "PSNR, dB", "fitted", "own, any shape", "own, square");
  double fitted = 0;
  std::optional<double> whole = 0.0, square = 0.0;
  for (const CoordinateCost& cost : costs) {
    fmt::print("{:<16} {:<8} {:>8.2f} {:>10.0f}   {:<19}   {:<19}\n", cost.object, cost.artists ? "artist" : "charts",
               cost.compared.psnr_db, cost.compared.texels, needs(cost.compared.texels, cost.whole_needs, cost.whole),
               needs(cost.compared.texels, cost.square_needs, cost.square));
    fitted += cost.compared.texels;
    *whole += cost.whole_needs.value_or(cost.whole.back().texels);
    *square += cost.square_needs.value_or(cost.square.back().texels);
  }
  fmt::print("{:<16} {:<8} {:>8} {:>10.0f}   {:<19}   {:<19}\n", "all", "", "", fitted, needs(fitted, whole, {}), needs(fitted, square, {}));
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
  print_costs(costs);
}

}  // namespace vitrine
