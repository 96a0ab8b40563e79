// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Pictures coded as videos: one for each block of the grid, along a zig-zag path.
#pragma once

#include <span>
#include <vector>

#include "host/base/progress.h"
#include "host/bench/compression.h"
#include "host/bench/video_coders.h"

namespace vitrine {

// The blocks of a grid that no field staggers.
FieldShape picture_blocks(const ParameterSpace& space);

struct ViewVideos {
  CompressionSeries series;
  VideoFormat best;  // of what the coder offers
};

// `pictures`: of all samples of the scene's space, flat; those of one block make a video. `bytes`: the targets. The coder's
// structures, pixel formats and the paths' fastest axes are tried one after the other at the targets' mean; the best are kept.
ViewVideos measure_view_videos(const Scene& scene, const std::vector<Picture>& pictures, const VideoCoder& coder,
                               VideoAccess access, std::span<const double> bytes, const VideoStudio& studio, Progress& progress);

}  // namespace vitrine
