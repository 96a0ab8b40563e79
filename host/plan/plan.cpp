// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/plan/plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "formats/image.h"
#include "formats/node_coding.h"
#include "host/plan/anchors.h"
#include "host/plan/demand.h"
#include "host/plan/sustained.h"

namespace vitrine {
namespace {

constexpr int kHorizons[] = {1, 2, 4, 8, 16, 32, 64};  // frames

// Bytes of a half-float RGBA texture with all MIP levels down to 1 x 1 (target/mip.h).
uint64_t composed_bytes(int width, int height) {
  uint64_t texels = 0;
  for (;; width = std::max(1, width / 2), height = std::max(1, height / 2)) {
    texels += static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
    if (width == 1 && height == 1) return 8 * texels;
  }
}

// A field's texture is uploaded when what is shown of it changes; in the first frame all are, also those that never change again.
uint64_t worst_upload(const std::vector<PlannedField>& fields) {
  uint64_t bytes = 0;
  for (const PlannedField& field : fields) bytes += composed_bytes(field.width, field.height);
  return bytes;
}

uint64_t largest(const std::vector<uint64_t>& values) {
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

// The most that one tile may cost, which is never split between frames: what its node costs beyond the least that all other
// tiles do, but no more than a tile in which every coefficient is coded.
uint64_t largest_tile(const std::vector<PlannedField>& fields) {
  constexpr uint64_t kSymbols = 3 * (kTileSize * kTileSize) * 3;  // of a bit each
  constexpr uint64_t kDensest = kUnitsPerNode + kUnitsPerTile + kSymbols * kUnitsPerSymbol + kSymbols / 8 * kUnitsPerByte + 2'000;
  uint64_t largest = 0;
  for (const PlannedField& field : fields) {
    const uint64_t tiles = static_cast<uint64_t>((field.width + kTileSize - 1) / kTileSize) *
                           static_cast<uint64_t>((field.height + kTileSize - 1) / kTileSize);
    for (const uint64_t units : field.encoded->node_units)
      if (units > (tiles - 1) * kUnitsPerTile)
        largest = std::max(largest, std::min(kDensest, units - (tiles - 1) * kUnitsPerTile));
  }
  return largest;
}

uint32_t frames_to_decode(uint64_t units, uint64_t per_frame) {
  return static_cast<uint32_t>(std::min<uint64_t>(limits::kFrames, (units + per_frame - 1) / per_frame));
}

Plan plan_for(const AnchorLattice& anchors, const std::vector<PlannedField>& fields, int horizon, const Profile& profile) {
  const Demand demand = find_demand(anchors, fields, horizon);
  const uint64_t tile = largest_tile(fields);
  Plan plan;
  plan.units_budget = profile.units_per_frame;
  plan.units_worst = worst_sustained_units(anchors, demand, horizon) + tile;
  for (const PoolDemand& pool : demand.pools) plan.cache_bytes += pool.worst_bytes();
  plan.settle_frames = frames_to_decode(largest(demand.displayed_units), plan.units_budget > tile ? plan.units_budget - tile : 1);
  plan.horizon_frames = static_cast<uint32_t>(horizon);
  return plan;
}

bool sustains(const Plan& plan) { return plan.units_worst <= plan.units_budget; }

}  // namespace

Plan make_plan(const ParameterSpace& space, const std::vector<float>& max_speed, const std::vector<PlannedField>& fields,
               bool interpolate, const Profile& profile) {
  const AnchorLattice anchors(space, max_speed, interpolate);
  Plan best;
  for (const int horizon : kHorizons) {
    const Plan plan = plan_for(anchors, fields, horizon, profile);
    // More horizon only ever needs more cache.
    if (horizon > kHorizons[0] && plan.cache_bytes > profile.cache_bytes) break;
    if (horizon == kHorizons[0] || plan.units_worst < best.units_worst) best = plan;
    if (sustains(best)) break;
  }
  best.upload_worst = worst_upload(fields);
  return best;
}

std::vector<std::string> misfits(const Plan& plan, const Profile& profile) {
  std::vector<std::string> found;
  const auto compare = [&](const char* what, uint64_t needed, uint64_t given, const char* remedy) {
    if (needed > given)
      found.push_back(fmt::format("{}: {} needed, profile {} has {}: {}", what, needed, profile.name, given, remedy));
  };
  compare("decoding units per frame at greatest speed", plan.units_worst, plan.units_budget,
          "lower max_speed, the objects' resolution_scale, or the storage");
  compare("cache bytes", plan.cache_bytes, profile.cache_bytes, "lower the objects' resolution_scale or max_speed");
  compare("upload bytes per frame", plan.upload_worst, profile.upload_bytes_per_frame, "lower the objects' resolution_scale");
  return found;
}

}  // namespace vitrine
