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
  const double rest = static_cast<double>(r.bounce_rays + r.shadow_rays);
  const double bare = r.rays() / (r.bare_camera + r.bare_rest) * 1e-6, traced = r.rays() / r.tracer * 1e-6;
  const double bare_rest = rest / r.bare_rest * 1e-6, traced_rest = rest / (r.tracer - r.bare_camera) * 1e-6;
  const double speedup = r.wall_two > 0 ? r.wall_one / r.wall_two : 0;
  if (common.json) {
    print_json({{"bench", "trace"},
                {"rows",
                 {{{"rays", "all"}, {"count", r.rays()}, {"bare_mrays_s", bare}, {"tracer_mrays_s", traced}, {"relative", r.share()}},
                  {{"rays", "bounces and shadows"}, {"count", rest}, {"bare_mrays_s", bare_rest}, {"tracer_mrays_s", traced_rest}, {"relative", r.share_of_bounces()}}}},
                {"threads_2_speedup", speedup}});
    return;
  }
  fmt::print("one thread           rays   bare Embree      tracer  relative\n");
  fmt::print("all            {:10.0f}  {:6.2f} Mray/s  {:4.2f} Mray/s  {:7.1f} %\n", r.rays(), bare, traced, 100 * r.share());
  fmt::print("bounces        {:10.0f}  {:6.2f} Mray/s  {:4.2f} Mray/s  {:7.1f} %   ({} of them shadow rays)\n", rest, bare_rest, traced_rest, 100 * r.share_of_bounces(), r.shadow_rays);
  if (speedup > 0) fmt::print("two threads: {:.2f} times as fast as one\n", speedup);
}

}  // namespace vitrine
