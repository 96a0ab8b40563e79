// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The plan: what the target must decode, when, and what that can cost at worst.
//
// Model. The space is cut into anchor cells, within which the displayed samples do not change (the nearest sample; or, where
// the picture interpolates, the 2^d corners). While the position is in a cell, all nodes are resident that can come to be
// displayed within `horizon` frames at the axes' greatest speeds; a node that enters with a step of the anchor therefore has
// at least `horizon` frames until it is needed. The tops of all pyramids (level 0) are pinned: decoded when the image is
// loaded, resident for ever. Discrete axes move by jumps only, and nothing is fetched ahead along them.
//
// In any k frames of motion a decoder that works on what is needed first gets U (k + horizon) units done before the last of
// what entered is due. units_worst is the least U with which that is enough for every window of every straight path: each
// axis alone and all combinations of axes, each at its own greatest speed, from every cell of the border; and one tile more, as
// a tile is never split between frames. Paths that turn are
// not searched: a hand that goes to and fro over a block's border can ask for more where nothing is kept beyond the cache that
// is declared; the engine counts what is late.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/block.h"
#include "formats/parameter_space.h"
#include "formats/surface_filter.h"
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
  SurfaceFilter filter = SurfaceFilter::kTrilinear;  // by which it reads textures
};
// A built-in name or the path of a profile file (TOML). Throws InputError.
Profile load_profile(const std::string& name_or_path, const std::string& source = "--profile");

struct PlannedField {
  AxisMask axes = 0;
  const EncodedField* encoded = nullptr;
  int width = 0, height = 0;  // texels of every node, and of the composed texture
};

struct Plan {
  uint64_t units_budget = 0, units_worst = 0;  // per frame: the profile's; what straight motion at greatest speed needs
  uint64_t upload_worst = 0;                   // bytes per frame: every composed texture once, as the first frame uploads them
  uint64_t cache_bytes = 0;     // decoded nodes (6 bytes a texel): largest resident set of each texture size, all tops
  uint32_t settle_frames = 0;   // after a jump to the costliest cell, at units_budget
  uint32_t horizon_frames = 0;  // >= 1
};

// Takes the shortest horizon with which the profile's units suffice; where none does within the profile's cache, the one that
// needs the fewest. Never refuses: see misfits. `max_speed`: samples per frame, one per axis.
Plan make_plan(const ParameterSpace& space, const std::vector<float>& max_speed, const std::vector<PlannedField>& fields,
               bool interpolate, const Profile& profile);

// What the profile does not provide for, a line each (empty: the plan fits): "WHAT: NEED, PROFILE: REMEDY".
std::vector<std::string> misfits(const Plan& plan, const Profile& profile);

}  // namespace vitrine
