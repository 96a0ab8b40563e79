// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Inferred textures coded as videos (Hakura 2001, section 4.4): one for each block of each field, as 8-bit companded pictures.
// Bytes are shared out over the videos by equal slopes, with the weights by which Vitrine shares them out over its own fields.
#pragma once

#include <span>
#include <vector>

#include "host/base/progress.h"
#include "host/bench/compression.h"
#include "host/bench/texture_drawer.h"
#include "host/bench/video_coders.h"
#include "host/encode/encode.h"

namespace vitrine {

// The textures as 8-bit pictures, loaded once for all coders.
class TexturePictureSet {
 public:
  // `sources`: of the inference's fields. References are kept.
  TexturePictureSet(const Inference& inference, const std::vector<FieldSource>& sources, Progress& progress);

  const Inference& inference() const { return inference_; }
  const FieldSource& source(size_t field) const { return sources_[field]; }
  const std::vector<Picture>& pictures(size_t field) const { return pictures_[field]; }  // by sample of the field's space, flat
  // Codes (formats/companding.h) in a step of 8 bits of the field's pictures: the largest code is 255.
  double code_step(size_t field) const { return steps_[field]; }
  LinearTexture texture(size_t field, const Picture& picture) const;

 private:
  const Inference& inference_;
  const std::vector<FieldSource>& sources_;
  std::vector<std::vector<Picture>> pictures_;
  std::vector<double> steps_;
};

// `truth`: the traced pictures of all samples. `bytes`: the targets, of the videos alone.
CompressionSeries measure_texture_videos(const Scene& scene, const TexturePictureSet& textures, const std::vector<Picture>& truth,
                                         TextureDrawer& drawer, const VideoFormat& format, VideoAccess access,
                                         std::span<const double> bytes, const VideoStudio& studio, Progress& progress);

}  // namespace vitrine
