// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <regex>

#include "formats/block.h"
#include "host/base/error.h"
#include "host/compile/compile.h"

namespace vitrine {
namespace {

double raw_bytes(const Scene& scene) {
  return 3.0 * scene.settings.width * scene.settings.height * static_cast<double>(scene.space().sample_count());
}

// Blocks of kMaxBlockSize samples along every axis that cover the grid.
double grid_blocks(const Scene& scene) {
  double blocks = 1;
  for (const Axis& axis : scene.axes) blocks *= (axis.shape.samples + kMaxBlockSize - 1) / kMaxBlockSize;
  return blocks;
}

}  // namespace

uint64_t storage_bytes(const std::string& storage, const Scene& scene, const std::string& source) {
  static const std::regex ratio(R"(\s*([0-9]+(?:\.[0-9]+)?)\s*:\s*1\s*)");
  static const std::regex amount(R"(\s*([0-9]+(?:\.[0-9]+)?)\s*(KB|MB|B)\s*(/\s*block)?\s*)");
  std::smatch match;
  double bytes = 0;
  if (storage.size() < 64 && std::regex_match(storage, match, ratio)) {
    const double r = std::stod(match[1]);
    if (r > 0) bytes = raw_bytes(scene) / r;
  } else if (storage.size() < 64 && std::regex_match(storage, match, amount)) {
    const double unit = match[2] == "MB" ? 1e6 : match[2] == "KB" ? 1e3 : 1;
    bytes = std::stod(match[1]) * unit * (match[3].matched ? grid_blocks(scene) : 1);
  }
  if (!(bytes >= 1) || bytes > 4e9) {
    throw InputError(source, "storage \"" + storage + "\" is not an amount", "write \"100:1\", \"150 KB/block\" or \"12 MB\" (up to 4 GB)");
  }
  return static_cast<uint64_t>(bytes);
}

}  // namespace vitrine
