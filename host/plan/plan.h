// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The plan: what the target must decode, when, and what that can cost at worst.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/block.h"
#include "formats/parameter_space.h"
#include "host/encode/encode.h"

namespace vitrine {

// What a target has.
struct Profile {
  std::string name;
  uint64_t units_per_frame = 0;
  uint64_t upload_bytes_per_frame = 0;
  uint64_t cache_bytes = 0;
  int supersampling = 2;
  int frames_per_second = 60;
};
// A built-in name or the path of a profile file (TOML). Throws InputError.
Profile load_profile(const std::string& name_or_path);

struct PlannedField {
  AxisMask axes = 0;
  const EncodedField* encoded = nullptr;
  int width = 0, height = 0;
};

struct Plan {
  uint64_t units_budget = 0, units_worst = 0;   // per frame
  uint64_t upload_worst = 0;                    // bytes per frame
  uint64_t cache_bytes = 0;
  uint32_t settle_frames = 0, horizon_frames = 0;
};

// Staggered block origins per field, decided before encoding: spread over the block so that block borders of different
// fields do not fall together.
AxisSizes stagger_of(int field, int field_count, const ParameterSpace& space, const AxisSizes& block_size);

Plan make_plan(const ParameterSpace& space, const std::vector<float>& max_speed, const std::vector<PlannedField>& fields, bool interpolate, const Profile& profile);

}  // namespace vitrine
