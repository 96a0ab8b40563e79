// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/bench/decode_rates.h"
#include "host/compile/compile.h"
#include "tools/commands/commands.h"
#include "tools/commands/image_input.h"
#include "tools/commands/print_json.h"
#include "tools/commands/scene_input.h"

namespace vitrine {
namespace {

nlohmann::json json_of(const DecodeRates& rates) {
  nlohmann::json rows = nlohmann::json::array();
  for (const DecodeRate& r : rates.rows) {
    nlohmann::json row = {{"coder", r.coder},
                          {"mtexel_s", r.texels_s / 1e6},
                          {"relative", r.relative},
                          {"bytes_s", r.bytes_s},
                          {"share_of_copy", r.share_of_copy}};
    if (r.bits_per_texel > 0) row["bits_per_texel"] = r.bits_per_texel, row["psnr_db"] = r.psnr_db;
    rows.push_back(row);
  }
  return {{"bench", "decode"},        {"rows", rows},
          {"nodes", rates.nodes},     {"texels", rates.texels},
          {"unit_ns", rates.unit_ns}, {"units_within_15_percent", rates.units_within}};
}

void print_rates(const DecodeRates& rates) {
  fmt::print("{} nodes of {} texels in all, one thread\n{:<14} {:>10} {:>9} {:>8} {:>9} {:>11} {:>8}\n", rates.nodes,
             rates.texels, "coder", "Mtexel/s", "relative", "GB/s", "of copy", "bits/texel", "PSNR, dB");
  for (const DecodeRate& r : rates.rows) {
    fmt::print("{:<14} {:>10.0f} {:>9.2f} {:>8.2f} {:>7.1f} %", r.coder, r.texels_s / 1e6, r.relative, r.bytes_s / 1e9,
               100 * r.share_of_copy);
    if (r.bits_per_texel > 0) fmt::print(" {:>11.4f} {:>8.2f}", r.bits_per_texel, r.psnr_db);
    fmt::print("\n");
  }
  fmt::print("a unit takes {:.2f} ns; {:.0f} % of all units lie in nodes that keep to it within 15 %\n", rates.unit_ns,
             100 * rates.units_within);
}

}  // namespace

void BenchDecodeCommand::run() const {
  const auto jobs = limit_jobs(common);
  const auto progress = make_progress(common);
  const OpenImage opened(image);
  const auto loaded = load_scene_of(opened.view(), image, scene, common);
  const std::filesystem::path folder = work.empty() ? default_work_folder(image) : std::filesystem::path(work);
  const Store store(folder);
  const auto inference = find_inference(*loaded, store, static_cast<int>(opened.view().directory().supersampling()),
                                        opened.view().filter(), *progress);
  if (!inference)
    throw InputError(folder.string(), "it has not the frames of the image", "name the work folder of its compile with --work");
  const NodePictures pictures = node_pictures(opened.view(), *inference, store, *progress);
  const DecodeRates rates = measure_decoding(pictures.nodes, rounds, *progress);
  if (common.json)
    print_json(json_of(rates));
  else
    print_rates(rates);
}

}  // namespace vitrine
