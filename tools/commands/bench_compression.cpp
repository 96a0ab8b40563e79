// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/frozen_scene.h"
#include "host/compile/compile.h"
#include "tools/commands/commands.h"
#include "tools/commands/scene_input.h"
#include "tools/commands/work_folder.h"

namespace vitrine {

void BenchCompressionCommand::run() const {
  const auto jobs = limit_jobs(common);
  const auto progress = make_progress(common);
  const auto loaded = load_scene_with(scene, common, [&](Scene& s) {
    apply_size(s, size);
    if (noise_db > 0) s.settings.noise_db = static_cast<float>(noise_db);
  });
  const WorkFolder folder(work);
  std::vector<int> counts;
  for (const Axis& axis : loaded->axes) counts.push_back(samples > 0 ? samples : axis.shape.samples);
  const Scene part = middle_part(*loaded, counts);
  trace_missing(part, Store(folder.path()), *progress);
}

}  // namespace vitrine
