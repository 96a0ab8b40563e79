// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host/bench/smoothing_costs.h"
#include "host/compile/preset.h"
#include "tools/commands/commands.h"
#include "tools/commands/print_json.h"
#include "tools/commands/scene_input.h"
#include "tools/commands/work_folder.h"

namespace vitrine {

void BenchSmoothingCommand::run() const {
  static constexpr float kStrengths[] = {0, 0.003f, 0.01f, 0.03f, 0.1f, 0.3f, 1};
  const auto jobs = limit_jobs(common);
  const auto progress = make_progress(common);
  const auto loaded = load_scene_with(scene, common, [&](Scene& s) { apply_preset(s, preset); });
  const WorkFolder folder(work);
  const auto rows = measure_smoothing(*loaded, kStrengths, folder.path(), *progress);
  if (common.json) {
    nlohmann::json list = nlohmann::json::array();
    for (const SmoothingRow& r : rows)
      list.push_back({{"smoothing", r.smoothing}, {"bytes", r.bytes}, {"inferred_db", r.inferred_db}, {"at_db", r.at_db},
                      {"between_db", r.between_db}, {"off_db", r.off_db}});
    return print_json({{"bench", "smoothing"}, {"rows", list}});
  }
  fmt::print("PSNR, dB, of images of one size\n{:>9} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "smoothing", "bytes", "inferred", "at", "between",
             "off");
  for (const SmoothingRow& r : rows)
    fmt::print("{:>9} {:>9} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f}\n", r.smoothing, r.bytes, r.inferred_db, r.at_db, r.between_db, r.off_db);
}

}  // namespace vitrine
