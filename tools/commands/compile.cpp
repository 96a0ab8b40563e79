// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/compile/compile.h"
#include "host/compile/preset.h"
#include "tools/commands/commands.h"
#include "tools/commands/print_json.h"
#include "tools/commands/scene_input.h"

namespace vitrine {

void CompileCommand::run() const {
  const auto jobs = limit_jobs(common);
  const auto progress = make_progress(common);
  const auto loaded = load_scene_with(scene, common, [&](Scene& s) {
    apply_preset(s, preset);
    if (!codec.empty()) s.settings.codec = codec == "spiht" ? NodeCoder::kSpiht : NodeCoder::kDct;
  });
  CompileOptions options;
  options.image = image;
  options.work = work.empty() ? default_work_folder(image) : std::filesystem::path(work);
  options.profile = profile;
  options.storage = storage;
  const CompileReport report = compile_scene(*loaded, options, *progress);
  if (!common.quiet)
    for (const std::string& warning : report.warnings) fmt::print(stderr, "vitrine: warning: {}\n", warning);
  const double ratio = static_cast<double>(report.raw_bytes) / static_cast<double>(report.bytes);
  if (common.json) {
    print_json({{"image", image}, {"bytes", report.bytes}, {"raw_bytes", report.raw_bytes}, {"ratio", ratio}, {"frames", report.frames},
                {"frames_rendered", report.frames_rendered}, {"seconds", report.seconds}, {"trace_seconds", report.trace_seconds},
                {"infer_seconds", report.infer_seconds}, {"encode_seconds", report.encode_seconds}});
  } else if (!common.quiet) {
    fmt::print("{}: {} bytes, {:.1f}:1, {} frames ({} traced now), {:.1f} s: tracing {:.1f}, inferring {:.1f}, coding {:.1f} ({:.0f} ms a sample)\n",
               image, report.bytes, ratio, report.frames, report.frames_rendered, report.seconds, report.trace_seconds, report.infer_seconds,
               report.encode_seconds, 1000 * report.encode_seconds / static_cast<double>(report.samples));
  }
}

}  // namespace vitrine
