// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Hakura's comparison (2001, section 4.8) with today's peers: a part of a scene's space, coded to the same numbers of bytes as
// pyramids of textures, as videos of the textures, and as videos of the pictures themselves. What is compared is always the
// framebuffer, 8-bit, with the traced frames, over all samples of the part.
//
// Bytes: of all that a target needs to show the part. Textures need meshes, too, which serve the whole space: a part of it is
// charged its share of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/base/progress.h"
#include "host/frames/store.h"
#include "host/scene/scene.h"
#include "host/verify/verify.h"

namespace vitrine {

// What one coder gives at one target.
struct CompressionRow {
  double ratio_target = 0, ratio = 0;
  double bytes = 0, psnr_db = 0;
  int decodes_per_access = 0;  // of frames or nodes, to see one picture or, of textures, one texture, at most
  double decode_ms = 0;        // processor time of that on one core: for a picture, of all its textures
  std::string settings;        // what was the best of what the coder offers
  Picture shown;               // the sample in the middle of the part
};

struct RatePsnr {
  double bytes = 0, psnr_db = 0;
};

enum class CoderKind : uint8_t { kVitrine, kTextureVideo, kViewVideo };

struct CompressionSeries {
  std::string coder;
  CoderKind kind = CoderKind::kVitrine;
  std::vector<CompressionRow> rows;  // one a target
  std::vector<RatePsnr> points;      // all that became known on the way, by bytes
};

struct CompressionReport {
  std::string scene;
  int width = 0, height = 0;
  int64_t samples = 0;
  double raw_bytes = 0, geometry_bytes = 0;  // geometry: what a part of the space is charged for meshes and the like
  double inferred_psnr_db = 0;               // of textures before any coding: what bounds those that are coded
  Picture truth;                             // the sample in the middle
  std::vector<CompressionSeries> series;
};

// By how many decibels the best of Vitrine's coders is ahead at a target; nothing where there are no such peers.
struct CompressionLead {
  std::string best;                     // of Vitrine's
  std::optional<double> random_access;  // of the best video that an access decodes kRandomDecodes frames of at most
  std::optional<double> mpeg4_one_key;  // of the pictures; where it ends above the target, at more bytes
  std::optional<double> av1_one_key;    // of the better of pictures and textures
};
CompressionLead lead_of(const CompressionReport& report, size_t target);

struct CompressionOptions {
  std::vector<double> ratios = {384, 768};  // of 24-bit pictures
  double share = 1;                         // of the space of which `scene` is a part (middle_part)
  bool videos = true;                       // the peers, which need ffmpeg
  std::vector<std::string> video_coders;    // of them, by name; none: all
};

// Frames and textures go to `store`, whose folder is `work`. Throws InputError, also where ffmpeg is missing.
CompressionReport measure_compression(const Scene& scene, const CompressionOptions& options, const std::filesystem::path& work,
                                      Progress& progress);

}  // namespace vitrine
