// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host/base/output_file.h"
#include "host/bench/compression.h"
#include "host/bench/frozen_scene.h"
#include "host/compile/compile.h"
#include "tools/commands/commands.h"
#include "tools/commands/compression_page.h"
#include "tools/commands/print_json.h"
#include "tools/commands/scene_input.h"
#include "tools/commands/work_folder.h"

namespace vitrine {
namespace {

nlohmann::json json_of(const CompressionLead& lead) {
  return {{"best", lead.best},
          {"random_access_db", json_or_null(lead.random_access)},
          {"mpeg4_one_key_db", json_or_null(lead.mpeg4_one_key)},
          {"av1_one_key_db", json_or_null(lead.av1_one_key)}};
}

nlohmann::json json_of(const CompressionReport& report) {
  nlohmann::json rows = nlohmann::json::array(), curves = nlohmann::json::object();
  for (const CompressionSeries& series : report.series) {
    for (const CompressionRow& row : series.rows)
      rows.push_back({{"coder", series.coder},
                      {"ratio_target", row.ratio_target},
                      {"ratio", row.ratio},
                      {"bytes", row.bytes},
                      {"psnr_db", row.psnr_db},
                      {"decodes_per_access", row.decodes_per_access},
                      {"decode_ms", row.decode_ms},
                      {"settings", row.settings},
                      {"scene", report.scene}});
    for (const RatePsnr& point : series.points)
      curves[series.coder].push_back({{"bytes", point.bytes}, {"psnr_db", point.psnr_db}});
  }
  nlohmann::json leads = nlohmann::json::array();
  for (size_t t = 0; t < report.series[0].rows.size(); ++t) leads.push_back(json_of(lead_of(report, t)));
  return {{"bench", "compression"},
          {"rows", rows},
          {"leads", leads},
          {"curves", curves},
          {"width", report.width},
          {"height", report.height},
          {"samples", report.samples},
          {"raw_bytes", report.raw_bytes},
          {"geometry_bytes", report.geometry_bytes},
          {"inferred_psnr_db", report.inferred_psnr_db}};
}

void print_lead(const CompressionLead& lead) {
  const auto print = [&](const std::optional<double>& ahead, const char* of) {
    if (ahead) fmt::print("  {}: {:+.2f} dB over {}\n", lead.best, *ahead, of);
  };
  print(lead.random_access, "the best video with equal random access");
  print(lead.mpeg4_one_key, "MPEG-4 Part 2 of the pictures with one key frame");
  print(lead.av1_one_key, "SVT-AV1 with one key frame, whose accesses take many decodes");
}

void print_report(const CompressionReport& report) {
  fmt::print("{}: {} samples of {} x {}; meshes take {:.0f} bytes; textures before coding {:.2f} dB\n", report.scene,
             report.samples, report.width, report.height, report.geometry_bytes, report.inferred_psnr_db);
  for (size_t t = 0; t < report.series[0].rows.size(); ++t) {
    fmt::print("{:.0f}:1\n  {:<32} {:>8} {:>9} {:>9} {:>8} {:>10}\n", report.series[0].rows[t].ratio_target, "coder", "ratio",
               "bytes", "PSNR, dB", "decodes", "ms/access");
    for (const CompressionSeries& series : report.series) {
      const CompressionRow& row = series.rows[t];
      fmt::print("  {:<32} {:>6.0f}:1 {:>9.0f} {:>9.2f} {:>8} {:>10.2f}\n", series.coder, row.ratio, row.bytes, row.psnr_db,
                 row.decodes_per_access, row.decode_ms);
    }
    print_lead(lead_of(report, t));
  }
  for (const CompressionSeries& series : report.series)
    if (series.kind != CoderKind::kVitrine) fmt::print("{} was best with {}\n", series.coder, series.rows[0].settings);
}

}  // namespace

void BenchCompressionCommand::run() const {
  if (!page.empty()) check_output_file(page);
  const auto jobs = limit_jobs(common);
  const auto progress = make_progress(common);
  const auto loaded = load_scene_with(scene, common, [&](Scene& s) {
    apply_size(s, size);
    if (noise_db > 0) s.settings.noise_db = static_cast<float>(noise_db);
  });
  const WorkFolder folder(work);
  const std::vector<int> counts(loaded->axes.size(), samples);
  const Scene part = samples > 0 ? middle_part(*loaded, counts) : Scene();
  const Scene& measured = samples > 0 ? part : *loaded;
  if (frames_only) {
    trace_missing(measured, Store(folder.path()), *progress);
    return;
  }
  CompressionOptions options;
  if (!ratios.empty()) options.ratios = ratios;
  options.share = static_cast<double>(measured.space().sample_count()) / static_cast<double>(loaded->space().sample_count());
  options.videos = !no_videos;
  options.video_coders = coders;
  const CompressionReport report = measure_compression(measured, options, folder.path(), *progress);
  if (!page.empty()) write_compression_page(page, report);
  if (common.json) return print_json(json_of(report));
  print_report(report);
}

}  // namespace vitrine
