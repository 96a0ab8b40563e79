// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/view_videos.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "host/base/field_blocks.h"
#include "host/bench/frozen_scene.h"
#include "host/bench/rate_curve.h"
#include "host/bench/sample_paths.h"

namespace vitrine {
namespace {

constexpr double kHalvingOfCrf = 6, kHalvingOfQuantizer = 8;

struct ViewVariant {
  VideoFormat format;
  int fastest = 0;  // axis
  bool operator==(const ViewVariant& o) const {
    return format.structure == o.format.structure && format.pixel_format == o.format.pixel_format && fastest == o.fastest;
  }
};

// One way of coding all blocks.
class BlockVideos {
 public:
  BlockVideos(const ParameterSpace& space, const std::vector<Picture>& pictures, ViewVariant variant, const VideoStudio& studio,
              Progress& progress)
      : pictures_(pictures),
        variant_(std::move(variant)),
        studio_(studio),
        progress_(progress),
        curve_(
            {variant_.format.coder->best, variant_.format.coder->worst, variant_.format.coder->whole_steps,
             variant_.format.coder->quality_option == "-crf" ? kHalvingOfCrf : kHalvingOfQuantizer},
            [this](double quality) { return code(quality); }, [this](double quality) { return errors_.at(quality); }) {
    const FieldShape blocks = picture_blocks(space);
    for (int block = 0; block < blocks.block_count(); ++block) {
      const std::vector<int64_t> path = zig_zag(space, blocks.samples_of(block), variant_.fastest);
      if (!path.empty()) paths_.push_back(path);
    }
  }
  BlockVideos(const BlockVideos&) = delete;
  BlockVideos& operator=(const BlockVideos&) = delete;

  Rated at(double bytes, double guess) { return curve_.at(bytes, guess); }
  std::vector<RatePsnr> points() const {
    std::vector<RatePsnr> points;
    for (const RateCurve::Point& point : curve_.points()) points.push_back({point.bytes, psnr_db(errors_.at(point.quality))});
    return points;
  }
  const ViewVariant& variant() const { return variant_; }
  int decodes() const { return decodes_; }
  double decode_ms(double quality) const { return studio_.decode_ms(variant_.format, video(0), quality); }
  Picture shown(int64_t sample, double quality) const {
    for (size_t v = 0; v < paths_.size(); ++v) {
      const auto at = std::find(paths_[v].begin(), paths_[v].end(), sample);
      if (at != paths_[v].end())
        return studio_.code(variant_.format, video(v), quality).pictures[static_cast<size_t>(at - paths_[v].begin())];
    }
    return {};
  }

 private:
  std::vector<Picture> video(size_t number) const {
    std::vector<Picture> frames;
    for (const int64_t sample : paths_[number]) frames.push_back(pictures_[static_cast<size_t>(sample)]);
    return frames;
  }

  double code(double quality) {
    std::vector<double> bytes(paths_.size()), errors(paths_.size());
    std::vector<int> decodes(paths_.size());
    tbb::parallel_for(size_t{0}, paths_.size(), [&](size_t v) {
      progress_.advance(0);
      const CodedVideo coded = studio_.code(variant_.format, video(v), quality);
      bytes[v] = static_cast<double>(coded.bytes);
      decodes[v] = coded.decodes;
      for (size_t i = 0; i < coded.pictures.size(); ++i)
        errors[v] += mean_squared_error(coded.pictures[i], pictures_[static_cast<size_t>(paths_[v][i])]);
    });
    double all_bytes = 0, all_errors = 0;
    for (size_t v = 0; v < paths_.size(); ++v)
      all_bytes += bytes[v], all_errors += errors[v], decodes_ = std::max(decodes_, decodes[v]);
    errors_[quality] = all_errors / static_cast<double>(pictures_.size());
    return all_bytes;
  }

  const std::vector<Picture>& pictures_;
  ViewVariant variant_;
  const VideoStudio& studio_;
  Progress& progress_;
  std::vector<std::vector<int64_t>> paths_;  // one a block
  std::map<double, double> errors_;          // by quality
  int decodes_ = 0;
  RateCurve curve_;
};

// The best way of coding, found by changing one choice after the other.
class BestVideos {
 public:
  BestVideos(const ParameterSpace& space, const std::vector<Picture>& pictures, const VideoCoder& coder, VideoAccess access,
             double bytes, const VideoStudio& studio, Progress& progress)
      : space_(space), pictures_(pictures), access_(access), bytes_(bytes), studio_(studio), progress_(progress) {
    const FieldShape blocks = picture_blocks(space);
    const std::vector<int> axes = path_axes(space, blocks.samples_of(0));
    ViewVariant variant{{&coder, coder.structures(access).front(), coder.pixel_formats.front()}, axes.front()};
    best_ = measure(variant);
    for (size_t i = 1; i < axes.size(); ++i) variant = best_->variant(), variant.fastest = axes[i], consider(variant);
    for (const std::string& structure : coder.structures(access))
      variant = best_->variant(), variant.format.structure = structure, consider(variant);
    for (const std::string& pixels : coder.pixel_formats)
      variant = best_->variant(), variant.format.pixel_format = pixels, consider(variant);
  }
  BlockVideos& videos() { return *best_; }

 private:
  std::unique_ptr<BlockVideos> measure(const ViewVariant& variant) {
    auto videos = std::make_unique<BlockVideos>(space_, pictures_, variant, studio_, progress_);
    const Rated rated = videos->at(bytes_, guess_);
    guess_ = rated.quality;
    error_ = rated.squared_error;
    // A coder whose range ends above the wanted bytes is compared where it ends.
    cost_ = std::log(error_) + std::log(std::max(1.0, rated.bytes / bytes_));
    return videos;
  }
  void consider(const ViewVariant& variant) {
    if (variant == best_->variant()) return;
    const double cost = cost_;
    auto videos = measure(variant);
    if (cost_ < cost && (access_ == VideoAccess::kOneKey || videos->decodes() <= kRandomDecodes))
      best_ = std::move(videos);
    else
      cost_ = cost;
  }

  const ParameterSpace& space_;
  const std::vector<Picture>& pictures_;
  VideoAccess access_;
  double bytes_;
  const VideoStudio& studio_;
  Progress& progress_;
  std::unique_ptr<BlockVideos> best_;
  double guess_ = 34, error_ = 0, cost_ = 0;
};

}  // namespace

FieldShape picture_blocks(const ParameterSpace& space) {
  FieldShape shape;
  shape.space = space;
  shape.block_size = block_size_of(space);
  shape.pyramid.cell[0] = shape.block_size;
  return shape;
}

ViewVideos measure_view_videos(const Scene& scene, const std::vector<Picture>& pictures, const VideoCoder& coder,
                               VideoAccess access, std::span<const double> bytes, const VideoStudio& studio, Progress& progress) {
  double logarithms = 0;
  for (const double target : bytes) logarithms += std::log(target) / static_cast<double>(bytes.size());
  const ParameterSpace space = scene.space();
  BestVideos best(space, pictures, coder, access, std::exp(logarithms), studio, progress);
  BlockVideos& videos = best.videos();
  ViewVideos result;
  result.best = videos.variant().format;
  result.series.kind = CoderKind::kViewVideo;
  result.series.coder = coder.name + " view, " + (access == VideoAccess::kOneKey ? "one key frame" : "random access");
  for (const double target : bytes) {
    const Rated rated = videos.at(target, coder.worst - 10);
    CompressionRow row;
    row.bytes = rated.bytes;
    row.psnr_db = rated.psnr_db();
    row.decodes_per_access = videos.decodes();
    row.decode_ms = videos.decode_ms(rated.quality) * row.decodes_per_access;
    row.settings = result.best.structure + ", " + result.best.pixel_format + ", " +
                   scene.axes[static_cast<size_t>(videos.variant().fastest)].name + " fastest";
    row.shown = videos.shown(middle_sample(scene), rated.quality);
    result.series.rows.push_back(std::move(row));
  }
  result.series.points = videos.points();
  return result;
}

}  // namespace vitrine
