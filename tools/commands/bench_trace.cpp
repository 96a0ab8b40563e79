// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host/bench/ray_rates.h"
#include "tools/commands/commands.h"
#include "tools/commands/print_json.h"
#include "tools/commands/scene_input.h"

namespace vitrine {

void BenchTraceCommand::run() const {
  const auto progress = make_progress(common);
  const auto loaded = load_scene_with(scene, common, [](Scene&) {});
  const RayRates r = measure_ray_rates(*loaded, samples_per_pixel, *progress);
  const double speedup = r.wall_two > 0 ? r.wall_one / r.wall_two : 0;
  const auto rate = [](const RayRates::Side& side, double seconds) { return static_cast<double>(side.rays) / seconds * 1e-6; };
  if (common.json) {
    const auto row = [&](const char* name, const RayRates::Side& side) {
      return nlohmann::json{{"rays", name},
                            {"count", side.rays},
                            {"shadow_rays", side.shadow_rays},
                            {"bare_mrays_s", rate(side, side.bare)},
                            {"tracer_mrays_s", rate(side, side.tracer)},
                            {"relative", side.relative()}};
    };
    print_json({{"bench", "trace"}, {"rows", {row("bounces", r.bounces), row("picture", r.picture)}}, {"two_threads", speedup}});
    return;
  }
  fmt::print("one thread           rays  bare Embree loop      tracer  relative\n");
  const auto print = [&](const char* name, const RayRates::Side& side) {
    fmt::print("{:<14} {:10}     {:5.2f} Mray/s  {:5.2f} Mray/s  {:6.1f} %   ({:.0f} % shadow rays)\n", name, side.rays, rate(side, side.bare),
               rate(side, side.tracer), 100 * side.relative(), 100.0 * static_cast<double>(side.shadow_rays) / static_cast<double>(side.rays));
  };
  print("bounces", r.bounces);
  print("whole picture", r.picture);
  if (speedup > 0) fmt::print("two threads: {:.2f} times as fast as one\n", speedup);
}

}  // namespace vitrine
