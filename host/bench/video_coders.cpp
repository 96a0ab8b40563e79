// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/video_coders.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <iterator>

#include "host/base/error.h"
#include "host/bench/program.h"
#include "host/bench/video_access.h"

namespace vitrine {
namespace {

constexpr const char* kInstall = "install ffmpeg (Debian: apt-get install ffmpeg)";
constexpr int kLeastSize = 64;  // SVT-AV1 takes no smaller pictures
constexpr int kTimings = 3, kRepetitions = 15;

// Colours keep all that 8 bits of Y, Cb, Cr hold of them, in both directions.
constexpr const char* kScaler = "accurate_rnd+full_chroma_int+full_chroma_inp+bicubic";

// One thread each, so that streams do not depend on the machine. `psnr`: without what serves the eye at PSNR's cost.
//
// Structures with random access: with n frames between that nothing refers to, any frame of I n P n P takes the key frame, both P
// and itself; likewise any of I n B n P, whose B is referred to; and a group of four takes four however it is built. SVT-AV1
// lets its last layer be referred to, so there longer groups take more than they seem to.
const VideoCoder kCoders[] = {
    {.name = "x264",
     .extension = "h264",
     .encoder = {"-c:v", "libx264", "-preset", "slower", "-tune", "psnr", "-threads", "1", "-bsf:v",
                 "filter_units=remove_types=6"},
     .quality_option = "-crf",
     .best = 1,
     .worst = 51,
     .parameters_option = "-x264-params",
     .parameters = "min-keyint=1:scenecut=0:open-gop=0:",
     .pixel_formats = {"yuv420p", "yuv444p"},
     .one_key = {"keyint=infinite", "keyint=infinite:bframes=8"},
     .random = {"keyint=9:bframes=3:b-adapt=0:b-pyramid=none", "keyint=7:bframes=2:b-adapt=0:b-pyramid=none",
                "keyint=13:bframes=5:b-adapt=0:b-pyramid=none", "keyint=17:bframes=7:b-adapt=0:b-pyramid=none",
                "keyint=9:bframes=7:b-adapt=0:b-pyramid=normal", "keyint=4:bframes=0"}},
    {.name = "x265",
     .extension = "hevc",
     .encoder = {"-c:v", "libx265", "-preset", "slower", "-tune", "psnr"},
     .quality_option = "-crf",
     .best = 1,
     .worst = 51,
     .parameters_option = "-x265-params",
     .parameters = "pools=none:frame-threads=1:info=0:log-level=error:min-keyint=1:scenecut=0:open-gop=0:",
     .pixel_formats = {"yuv420p", "yuv444p"},
     .one_key = {"keyint=-1", "keyint=-1:bframes=16"},
     .random = {"keyint=9:bframes=3:b-adapt=0:b-pyramid=0", "keyint=7:bframes=2:b-adapt=0:b-pyramid=0",
                "keyint=13:bframes=5:b-adapt=0:b-pyramid=0", "keyint=17:bframes=7:b-adapt=0:b-pyramid=0",
                "keyint=9:bframes=7:b-adapt=0:b-pyramid=1"}},
    {.name = "svt-av1",
     .extension = "obu",
     .encoder = {"-c:v", "libsvtav1", "-preset", "4"},
     .quality_option = "-crf",
     .best = 1,
     .worst = 63,
     .whole_steps = true,
     .parameters_option = "-svtav1-params",
     .parameters = "lp=1:tune=1:scd=0:",
     .pixel_formats = {"yuv420p"},
     .one_key = {"keyint=-1", "keyint=-1:enable-tf=0"},
     .random = {"keyint=4", "keyint=4:enable-tf=0", "keyint=4:hierarchical-levels=2"}},
    {.name = "mpeg4",
     .extension = "m4v",
     .encoder = {"-c:v", "mpeg4", "-mbd", "rd", "-trellis", "2", "-cmp", "rd", "-subcmp", "rd", "-flags", "+mv4", "-sc_threshold",
                 "1000000000"},
     .quality_option = "-q:v",
     .best = 1,
     .worst = 31,
     .parameters_option = "-bf",
     .pixel_formats = {"yuv420p"},
     .one_key = {"2", "0"}},
};

std::string last_line(const std::string& text) {
  const size_t end = text.find_last_not_of(" \r\n");
  if (end == std::string::npos) return "without a word";
  const size_t begin = text.find_last_of("\r\n", end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1, end - (begin == std::string::npos ? 0 : begin + 1) + 1);
}

ProgramRun ffmpeg(std::vector<std::string> arguments, const std::string& log_level = "error") {
  std::vector<std::string> all{"ffmpeg", "-hide_banner", "-nostdin", "-y", "-loglevel", log_level};
  all.insert(all.end(), std::make_move_iterator(arguments.begin()), std::make_move_iterator(arguments.end()));
  ProgramRun run = run_program(all);
  if (run.exit_code != 0) throw InputError("ffmpeg", last_line(run.output), kInstall);
  return run;
}

// Even, and large enough for all coders.
int padded_size(int size) { return std::max(kLeastSize, (size + 1) / 2 * 2); }

// Beyond the right and the lower edge, the edge goes on.
void write_pictures(const std::filesystem::path& file, const std::vector<Picture>& pictures) {
  std::ofstream out(file, std::ios::binary);
  for (const Picture& picture : pictures) {
    const int width = padded_size(picture.width), height = padded_size(picture.height);
    std::vector<char> rows;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const int from = std::min(y, picture.height - 1) * picture.width + std::min(x, picture.width - 1);
        for (int c = 0; c < 3; ++c) rows.push_back(static_cast<char>(picture.rgb[static_cast<size_t>(3 * from + c)]));
      }
    out.write(rows.data(), static_cast<std::streamsize>(rows.size()));
  }
  if (!out.flush()) throw InputError(file.string(), "it cannot be written", "free some space");
}

std::vector<std::byte> read_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  return {bytes, bytes + text.size()};
}

std::vector<Picture> read_pictures(const std::filesystem::path& file, int width, int height, size_t count) {
  const std::vector<std::byte> bytes = read_bytes(file);
  const auto columns = static_cast<size_t>(padded_size(width)), rows = static_cast<size_t>(padded_size(height));
  if (bytes.size() != 3 * columns * rows * count)
    throw InputError("ffmpeg", "a stream has not as many pictures as went into it", "use ffmpeg 5.1 or newer");
  std::vector<Picture> pictures;
  for (size_t n = 0; n < count; ++n) {
    Picture picture{width, height, {}};
    for (size_t y = 0; y < static_cast<size_t>(height); ++y) {
      const auto* row = reinterpret_cast<const uint8_t*>(bytes.data()) + 3 * columns * (n * rows + y);
      picture.rgb.insert(picture.rgb.end(), row, row + 3 * static_cast<size_t>(width));
    }
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

// A file that goes away again.
class ScratchFile {
 public:
  ScratchFile(const std::filesystem::path& folder, const std::string& extension) {
    static std::atomic<int> count{0};
    path_ = folder / fmt::format("{}-{}.{}", getpid(), count++, extension);
  }
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::string name() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

std::vector<std::string> encode_arguments(const VideoFormat& format, int width, int height, double quality,
                                          const std::string& from, const std::string& to) {
  const VideoCoder& coder = *format.coder;
  std::vector<std::string> arguments{"-f",          "rawvideo",
                                     "-pix_fmt",    "rgb24",
                                     "-video_size", fmt::format("{}x{}", padded_size(width), padded_size(height)),
                                     "-framerate",  "25",
                                     "-i",          from,
                                     "-vf",         std::string("scale=flags=") + kScaler,
                                     "-pix_fmt",    format.pixel_format};
  arguments.insert(arguments.end(), coder.encoder.begin(), coder.encoder.end());
  for (const std::string& argument :
       {coder.quality_option, fmt::format("{:g}", quality), coder.parameters_option, coder.parameters + format.structure})
    arguments.push_back(argument);
  // No group of frames but those of the structure (12 is ffmpeg's own).
  if (coder.name == "mpeg4") arguments.insert(arguments.end(), {"-g", "600"});
  arguments.push_back(to);
  return arguments;
}

int decodes_of(const VideoCoder& coder, const std::string& stream) {
  if (coder.extension == "obu")
    return decodes_of_av1(ffmpeg({"-i", stream, "-c", "copy", "-bsf:v", "trace_headers", "-f", "null", "-"}, "info").output);
  const std::vector<std::byte> bytes = read_bytes(stream);
  if (coder.extension == "h264") return decodes_of_h264(bytes);
  if (coder.extension == "hevc") return decodes_of_hevc(bytes);
  return decodes_of_mpeg4(bytes);
}

void encode(const VideoFormat& format, const std::vector<Picture>& pictures, double quality, const std::filesystem::path& scratch,
            const ScratchFile& stream) {
  const ScratchFile raw(scratch, "rgb");
  write_pictures(raw.path(), pictures);
  ffmpeg(encode_arguments(format, pictures[0].width, pictures[0].height, quality, raw.name(), stream.name()));
}

}  // namespace

std::span<const VideoCoder> video_coders() { return kCoders; }

void require_ffmpeg() {
  ProgramRun run;
  try {
    run = run_program({"ffmpeg", "-hide_banner", "-encoders"});
  } catch (const InputError&) {
    throw InputError("ffmpeg", "it is not there", kInstall);
  }
  for (const VideoCoder& coder : kCoders)
    if (run.output.find(' ' + coder.encoder[1] + ' ') == std::string::npos)
      throw InputError("ffmpeg", "it has no encoder " + coder.encoder[1], kInstall);
}

VideoStudio::VideoStudio(std::filesystem::path scratch) : scratch_(std::move(scratch)) {
  std::error_code error;
  std::filesystem::create_directories(scratch_, error);
  if (error) throw InputError(scratch_.string(), "the folder cannot be made", "name another with --work");
}

CodedVideo VideoStudio::code(const VideoFormat& format, const std::vector<Picture>& pictures, double quality) const {
  const ScratchFile stream(scratch_, format.coder->extension), decoded(scratch_, "rgb");
  encode(format, pictures, quality, scratch_, stream);
  ffmpeg({"-threads", "1", "-i", stream.name(), "-vsync", "passthrough", "-vf", std::string("scale=flags=") + kScaler, "-pix_fmt",
          "rgb24", "-f", "rawvideo", decoded.name()});
  return {std::filesystem::file_size(stream.path()), decodes_of(*format.coder, stream.name()),
          read_pictures(decoded.path(), pictures[0].width, pictures[0].height, pictures.size())};
}

double VideoStudio::decode_ms(const VideoFormat& format, const std::vector<Picture>& pictures, double quality) const {
  const ScratchFile stream(scratch_, format.coder->extension), longer(scratch_, format.coder->extension);
  encode(format, pictures, quality, scratch_, stream);
  // Raw streams of whole groups follow one another; a longer one less a short one leaves out what it takes to start.
  const std::vector<std::byte> bytes = read_bytes(stream.path());
  std::ofstream out(longer.path(), std::ios::binary);
  for (int i = 0; i <= kRepetitions; ++i)
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) throw InputError(longer.name(), "it cannot be written", "free some space");
  const auto seconds = [&](const ScratchFile& file) {
    double least = INFINITY;
    for (int i = 0; i < kTimings; ++i)
      least = std::min(least, ffmpeg({"-threads", "1", "-i", file.name(), "-f", "null", "-"}).cpu_seconds);
    return least;
  };
  return std::max(0.0, 1000 * (seconds(longer) - seconds(stream)) / (kRepetitions * static_cast<double>(pictures.size())));
}

}  // namespace vitrine
