// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/block.h"
#include "host/base/error.h"
#include "host/compile/compile.h"
#include "host/scene/storage_text.h"

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
  double bytes = 0;
  if (const auto text = parse_storage(storage)) {
    bytes = text->unit == StorageUnit::kRatio           ? raw_bytes(scene) / text->amount
            : text->unit == StorageUnit::kBytesPerBlock ? text->amount * grid_blocks(scene)
                                                        : text->amount;
  }
  if (!(bytes >= 1) || bytes > 4e9) {
    throw InputError(source, "storage \"" + storage + "\" is not an amount", "write \"100:1\" (at least 1:1), \"150 KB/block\" or \"12 MB\" (up to 4 GB)");
  }
  return static_cast<uint64_t>(bytes);
}

}  // namespace vitrine
