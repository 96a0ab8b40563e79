// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Today's video coders, by way of ffmpeg: pictures in, a raw stream and the decoded pictures out. What they are told is said in
// video_coders.cpp; each is set for the best PSNR that it has to offer.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "host/verify/verify.h"

namespace vitrine {

enum class VideoAccess : uint8_t {
  kOneKey,  // one key frame: the most coherence there is to use
  kRandom,  // any frame with kRandomDecodes decoded frames at most
};
inline constexpr int kRandomDecodes = 4;

struct VideoCoder {
  std::string name;                           // "x264"
  std::string extension;                      // of its raw streams, by which ffmpeg knows them
  std::vector<std::string> encoder;           // arguments
  std::string quality_option;                 // "-crf"
  double best = 0, worst = 0;                 // the range of qualities: the larger, the fewer bytes
  bool whole_steps = false;                   // qualities are whole numbers
  std::string parameters_option, parameters;  // what a structure is appended to
  std::vector<std::string> pixel_formats;     // the first is the one that all have
  std::vector<std::string> one_key, random;   // structures, of which the best is to be found; empty: not offered
  const std::vector<std::string>& structures(VideoAccess access) const {
    return access == VideoAccess::kOneKey ? one_key : random;
  }
};
std::span<const VideoCoder> video_coders();

struct VideoFormat {
  const VideoCoder* coder = nullptr;
  std::string structure, pixel_format;
};

struct CodedVideo {
  uint64_t bytes = 0;  // of the raw stream
  int decodes = 0;     // of frames to see one, at most
  std::vector<Picture> pictures;
};

// Throws InputError where ffmpeg, or one of the coders in it, is missing.
void require_ffmpeg();

class VideoStudio {
 public:
  explicit VideoStudio(std::filesystem::path scratch);  // a folder for streams; created; may be shared between threads

  // `pictures`: of one size, any size. Throws InputError where ffmpeg fails.
  CodedVideo code(const VideoFormat& format, const std::vector<Picture>& pictures, double quality) const;
  // Processor milliseconds in which one core decodes a frame, of a stream as code() makes it.
  double decode_ms(const VideoFormat& format, const std::vector<Picture>& pictures, double quality) const;

 private:
  std::filesystem::path scratch_;
};

}  // namespace vitrine
