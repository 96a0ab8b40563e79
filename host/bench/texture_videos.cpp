// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/texture_videos.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "formats/color.h"
#include "formats/companding.h"
#include "host/bench/frozen_scene.h"
#include "host/bench/rate_curve.h"
#include "host/bench/sample_paths.h"
#include "host/infer/fields.h"

namespace vitrine {
namespace {

constexpr int kQualities = 5;        // of which a video's rate-distortion curve is made
constexpr double kBestQuality = 16;  // the first of them; the last is the coder's worst

std::vector<RgbCode> codes_of(const CodedPlanes& planes) {
  const size_t texels = planes.size() / 3;
  std::vector<RgbCode> codes;
  for (size_t i = 0; i < texels; ++i) codes.push_back(rgb_from_ycocg({planes[i], planes[texels + i], planes[2 * texels + i]}));
  return codes;
}

// A field's block: what one video holds, along one of several paths.
struct TextureBlock {
  size_t field = 0;
  std::vector<std::vector<int64_t>> paths;
  const std::vector<float>* importance = nullptr;  // per texel
};

std::vector<TextureBlock> blocks_of_all(const TexturePictureSet& textures) {
  std::vector<TextureBlock> blocks;
  for (size_t f = 0; f < textures.inference().fields.size(); ++f) {
    const FieldShape shape = blocks_of(textures.inference().fields[f]);
    const FieldSource& source = textures.source(f);
    for (int number = 0; number < shape.block_count(); ++number) {
      TextureBlock block{
          f, {}, &source.importance[source.block_maps.empty() ? 0 : source.block_maps[static_cast<size_t>(number)]]};
      const FieldShape::Box box = shape.samples_of(number);
      for (const int axis : path_axes(shape.space, box)) block.paths.push_back(zig_zag(shape.space, box, axis));
      blocks.push_back(std::move(block));
    }
  }
  return blocks;
}

struct BlockPoint {
  size_t path = 0;
  double quality = 0, bytes = 0, error = 0;  // error: as EncodedField::squared_error, times samples_shown
};

// What one block costs at which quality. The path is the one that is best at a slope.
class BlockCurve {
 public:
  void add(const BlockPoint& point) { points_.push_back(point); }
  // The quality at which an error of `slope` less costs one byte more, and the path.
  BlockPoint at_slope(double slope) const {
    const auto cost = [&](const BlockPoint& p) { return p.error + slope * p.bytes; };
    const BlockPoint best = *std::min_element(points_.begin(), points_.end(),
                                              [&](const BlockPoint& a, const BlockPoint& b) { return cost(a) < cost(b); });
    return between(hull(best.path), slope);
  }

 private:
  // The points of a path from which no two neighbours' line passes below, by quality.
  std::vector<BlockPoint> hull(size_t path) const {
    std::vector<BlockPoint> result;
    for (const BlockPoint& p : points_) {
      if (p.path != path || (!result.empty() && p.bytes >= result.back().bytes)) continue;
      while (result.size() > 1 && slope_of(result[result.size() - 2], result.back()) > slope_of(result.back(), p))
        result.pop_back();
      result.push_back(p);
    }
    return result;
  }
  // Of error over bytes, from one point to the next worse one.
  static double slope_of(const BlockPoint& a, const BlockPoint& b) {
    return std::max(1e-9, (b.error - a.error) / std::max(1e-9, a.bytes - b.bytes));
  }
  // A segment's slope is that of the quality in its middle; between middles the logarithm of slopes is straight.
  static BlockPoint between(const std::vector<BlockPoint>& hull, double slope) {
    BlockPoint result = hull.front();
    if (hull.size() < 2) return result;
    std::vector<std::pair<double, double>> middles;  // logarithm of slope, quality
    for (size_t i = 1; i < hull.size(); ++i)
      middles.push_back({std::log(slope_of(hull[i - 1], hull[i])), (hull[i - 1].quality + hull[i].quality) / 2});
    const double wanted = std::log(slope);
    size_t i = 1;
    while (i + 1 < middles.size() && middles[i].first < wanted) ++i;
    if (middles.size() == 1) {
      result.quality = wanted < middles[0].first ? hull.front().quality : hull.back().quality;
    } else {
      const auto [s0, q0] = middles[i - 1];
      const auto [s1, q1] = middles[i];
      result.quality = q0 + (q1 - q0) * (wanted - s0) / std::max(1e-9, s1 - s0);
    }
    result.quality = std::clamp(result.quality, hull.front().quality, hull.back().quality);
    result.bytes = bytes_at(hull, result.quality);
    return result;
  }
  static double bytes_at(const std::vector<BlockPoint>& hull, double quality) {
    for (size_t i = 1; i < hull.size(); ++i)
      if (quality <= hull[i].quality) {
        const double t = (quality - hull[i - 1].quality) / (hull[i].quality - hull[i - 1].quality);
        return std::exp((1 - t) * std::log(hull[i - 1].bytes) + t * std::log(hull[i].bytes));
      }
    return hull.back().bytes;
  }

  std::vector<BlockPoint> points_;  // of each path by quality
};

class TextureVideos {
 public:
  TextureVideos(const Scene& scene, const TexturePictureSet& textures, const std::vector<Picture>& truth, TextureDrawer& drawer,
                const VideoFormat& format, const VideoStudio& studio, Progress& progress)
      : scene_(scene),
        textures_(textures),
        truth_(truth),
        drawer_(drawer),
        format_(format),
        studio_(studio),
        progress_(progress),
        blocks_(blocks_of_all(textures)),
        curves_(blocks_.size()),
        // Rates go by the logarithm of the slope, of which about 2.5 octaves halve the bytes.
        rate_(
            {-40, 80, false, 2.5}, [this](double slope) { return code_all(slope); },
            [this](double slope) { return error_of(slope); }) {
    measure_curves();
  }

  CompressionRow at(double bytes) {
    const Rated rated = rate_.at(bytes, guess(bytes));
    CompressionRow row;
    row.bytes = rated.bytes;
    row.psnr_db = rated.psnr_db();
    row.decodes_per_access = decodes_;
    row.decode_ms = decode_ms(rated.quality);
    row.settings = format_.structure + ", " + format_.pixel_format;
    row.shown = draw(middle_sample(scene_), decoded_.at(rated.quality));
    return row;
  }
  std::vector<RatePsnr> points() const {
    std::vector<RatePsnr> points;
    for (const RateCurve::Point& p : rate_.points())
      if (p.squared_error) points.push_back({p.bytes, psnr_db(*p.squared_error)});
    return points;
  }

 private:
  using Decoded = std::vector<std::vector<Picture>>;  // by field and sample

  std::vector<Picture> video(const TextureBlock& block, size_t path) const {
    std::vector<Picture> frames;
    for (const int64_t sample : block.paths[path]) frames.push_back(textures_.pictures(block.field)[static_cast<size_t>(sample)]);
    return frames;
  }

  double error_of(const TextureBlock& block, const std::vector<Picture>& originals, const std::vector<Picture>& coded) const {
    const double step = textures_.code_step(block.field), shown = textures_.source(block.field).samples_shown;
    double sum = 0;
    for (size_t n = 0; n < originals.size(); ++n)
      for (size_t i = 0; i < block.importance->size(); ++i)
        for (size_t c = 0; c < 3; ++c) {
          const double difference = step * (originals[n].rgb[3 * i + c] - coded[n].rgb[3 * i + c]);
          sum += static_cast<double>((*block.importance)[i]) * difference * difference / 3;
        }
    return shown * sum;
  }

  double quality_number(int i) const {
    const VideoCoder& coder = *format_.coder;
    const double quality = kBestQuality + (coder.worst - kBestQuality) * i / (kQualities - 1);
    return coder.whole_steps ? std::round(quality) : quality;
  }

  void measure_curves() {
    std::vector<std::pair<size_t, BlockPoint>> tasks;
    for (size_t b = 0; b < blocks_.size(); ++b)
      for (size_t path = 0; path < blocks_[b].paths.size(); ++path)
        for (int i = 0; i < kQualities; ++i) tasks.push_back({b, {path, quality_number(i), 0, 0}});
    tbb::parallel_for(size_t{0}, tasks.size(), [&](size_t t) {
      progress_.advance(0);
      auto& [b, point] = tasks[t];
      const std::vector<Picture> originals = video(blocks_[b], point.path);
      const CodedVideo coded = studio_.code(format_, originals, point.quality);
      point.bytes = static_cast<double>(coded.bytes);
      point.error = error_of(blocks_[b], originals, coded.pictures);
    });
    for (const auto& [b, point] : tasks) curves_[b].add(point);
  }

  // The slope at which the curves promise so many bytes.
  double guess(double bytes) const {
    double low = -40, high = 80;
    for (int i = 0; i < 50; ++i) {
      const double middle = (low + high) / 2;
      double promised = 0;
      for (const BlockCurve& curve : curves_) promised += curve.at_slope(std::exp2(middle)).bytes;
      (promised > bytes ? low : high) = middle;
    }
    return high;
  }

  double quality_at(size_t block, double slope, size_t& path) const {
    const BlockPoint point = curves_[block].at_slope(std::exp2(slope));
    path = point.path;
    return format_.coder->whole_steps ? std::round(point.quality) : point.quality;
  }

  double code_all(double slope) {
    Decoded decoded;
    for (size_t f = 0; f < textures_.inference().fields.size(); ++f) decoded.emplace_back(textures_.pictures(f).size());
    std::vector<double> bytes(blocks_.size());
    std::vector<int> decodes(blocks_.size());
    tbb::parallel_for(size_t{0}, blocks_.size(), [&](size_t b) {
      progress_.advance(0);
      size_t path = 0;
      const double quality = quality_at(b, slope, path);
      CodedVideo coded = studio_.code(format_, video(blocks_[b], path), quality);
      bytes[b] = static_cast<double>(coded.bytes);
      decodes[b] = coded.decodes;
      for (size_t i = 0; i < coded.pictures.size(); ++i)
        decoded[blocks_[b].field][static_cast<size_t>(blocks_[b].paths[path][i])] = std::move(coded.pictures[i]);
    });
    decoded_[slope] = std::move(decoded);
    double sum = 0;
    for (size_t b = 0; b < blocks_.size(); ++b) sum += bytes[b], decodes_ = std::max(decodes_, decodes[b]);
    return sum;
  }

  Picture draw(int64_t sample, const Decoded& decoded) {
    return drawer_.draw(
        sample, [&](size_t field, int64_t own) { return textures_.texture(field, decoded[field][static_cast<size_t>(own)]); });
  }

  double error_of(double slope) {
    double sum = 0;
    for (size_t sample = 0; sample < truth_.size(); ++sample) {
      progress_.advance(0);
      sum += mean_squared_error(draw(static_cast<int64_t>(sample), decoded_.at(slope)), truth_[sample]);
    }
    return sum / static_cast<double>(truth_.size());
  }

  // Of all textures that one picture shows: a video of each field.
  double decode_ms(double slope) const {
    double sum = 0;
    std::vector<bool> seen(textures_.inference().fields.size());
    for (size_t b = 0; b < blocks_.size(); ++b) {
      if (seen[blocks_[b].field]) continue;
      seen[blocks_[b].field] = true;
      size_t path = 0;
      const double quality = quality_at(b, slope, path);
      const std::vector<Picture> frames = video(blocks_[b], path);
      sum += studio_.decode_ms(format_, frames, quality) * std::min(decodes_, static_cast<int>(frames.size()));
    }
    return sum;
  }

  const Scene& scene_;
  const TexturePictureSet& textures_;
  const std::vector<Picture>& truth_;
  TextureDrawer& drawer_;
  const VideoFormat& format_;
  const VideoStudio& studio_;
  Progress& progress_;
  std::vector<TextureBlock> blocks_;
  std::vector<BlockCurve> curves_;
  std::map<double, Decoded> decoded_;  // by slope
  int decodes_ = 0;
  RateCurve rate_;
};

}  // namespace

TexturePictureSet::TexturePictureSet(const Inference& inference, const std::vector<FieldSource>& sources, Progress& progress)
    : inference_(inference), sources_(sources) {
  for (const FieldSource& source : sources) {
    progress.advance(0);
    std::vector<std::vector<RgbCode>> codes;
    int largest = kCodeWhite;
    for (int64_t sample = 0; sample < source.space.sample_count(); ++sample) {
      codes.push_back(codes_of(source.load(sample)));
      for (const RgbCode& c : codes.back()) largest = std::max({largest, c.r, c.g, c.b});
    }
    steps_.push_back(largest / 255.0);
    pictures_.emplace_back();
    for (const std::vector<RgbCode>& own : codes) {
      Picture picture{source.width, source.height, {}};
      for (const RgbCode& c : own)
        for (const int code : {c.r, c.g, c.b}) picture.rgb.push_back(static_cast<uint8_t>(std::lround(code / steps_.back())));
      pictures_.back().push_back(std::move(picture));
    }
  }
}

LinearTexture TexturePictureSet::texture(size_t field, const Picture& picture) const {
  LinearTexture texture{picture.width, picture.height, {}};
  const auto radiance = [&](uint8_t value) { return radiance_from_code(static_cast<int>(std::lround(value * steps_[field]))); };
  for (size_t i = 0; i < picture.rgb.size(); i += 3)
    texture.texels.emplace_back(radiance(picture.rgb[i]), radiance(picture.rgb[i + 1]), radiance(picture.rgb[i + 2]));
  return texture;
}

CompressionSeries measure_texture_videos(const Scene& scene, const TexturePictureSet& textures, const std::vector<Picture>& truth,
                                         TextureDrawer& drawer, const VideoFormat& format, VideoAccess access,
                                         std::span<const double> bytes, const VideoStudio& studio, Progress& progress) {
  TextureVideos videos(scene, textures, truth, drawer, format, studio, progress);
  CompressionSeries series;
  series.coder = format.coder->name + " texture, " + (access == VideoAccess::kOneKey ? "one key frame" : "random access");
  series.kind = CoderKind::kTextureVideo;
  for (const double target : bytes) series.rows.push_back(videos.at(target));
  series.points = videos.points();
  return series;
}

}  // namespace vitrine
