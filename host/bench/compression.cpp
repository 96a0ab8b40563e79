// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/compression.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>

#include "hal/backends.h"
#include "host/base/error.h"
#include "host/bench/coded_textures.h"
#include "host/bench/frozen_scene.h"
#include "host/bench/texture_videos.h"
#include "host/bench/view_videos.h"
#include "host/compile/compile.h"
#include "host/verify/reference.h"

namespace vitrine {
namespace {

std::vector<Picture> traced_pictures(const Scene& scene, const std::vector<StoreKey>& frames, const Store& store,
                                     Progress& progress) {
  std::vector<Picture> pictures;
  for (const StoreKey& key : frames) {
    progress.advance(0);
    const auto frame = store.load_frame(key, scene);
    if (!frame) throw InputError("work folder", "a frame is gone", "run the same command again");
    Picture picture{frame->width, frame->height, {}};
    for (const glm::vec3& radiance : frame->combined)
      for (int c = 0; c < 3; ++c) picture.rgb.push_back(srgb8_from_radiance(scene.settings.exposure * radiance[c]));
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

struct Contest {
  const VideoCoder* coder;
  VideoAccess access;
};

bool is_wanted(const VideoCoder& coder, const std::vector<std::string>& names) {
  return names.empty() || std::find(names.begin(), names.end(), coder.name) != names.end();
}

std::vector<Contest> contests(const std::vector<std::string>& names) {
  std::vector<Contest> result;
  for (const VideoCoder& coder : video_coders())
    for (const VideoAccess access : {VideoAccess::kOneKey, VideoAccess::kRandom})
      if (!coder.structures(access).empty() && is_wanted(coder, names)) result.push_back({&coder, access});
  return result;
}

class Contestants {
 public:
  Contestants(const Scene& scene, const CompressionOptions& options, const std::filesystem::path& work, Progress& progress)
      : scene_(scene),
        options_(options),
        progress_(progress),
        store_(work),
        studio_(work / "scratch"),
        profile_(load_profile(scene.settings.profile, scene.file.string() + ": target.profile")) {}

  CompressionReport run() {
    trace_missing(scene_, store_, progress_);
    frames_ = frame_keys(scene_);
    truth_ = traced_pictures(scene_, frames_, store_, progress_);
    const auto inference = find_inference(scene_, store_, profile_.supersampling, profile_.filter, progress_);
    if (!inference) throw InputError("work folder", "a frame is gone", "run the same command again");
    describe(*inference);
    report_.inferred_psnr_db = inferred_psnr(*inference);
    measure_ours(*inference);
    if (options_.videos) measure_videos(*inference);
    for (CompressionSeries& series : report_.series) finish(series);
    return std::move(report_);
  }

 private:
  void describe(const Inference& inference) {
    report_.scene = scene_.name;
    report_.width = scene_.settings.width;
    report_.height = scene_.settings.height;
    report_.samples = scene_.space().sample_count();
    report_.raw_bytes = 3.0 * report_.width * report_.height * static_cast<double>(report_.samples);
    report_.truth = truth_[static_cast<size_t>(middle_sample(scene_))];
    PartOfStep part(progress_);
    report_.geometry_bytes = options_.share * geometry_bytes(scene_, inference, store_, profile_, part);
    for (const double ratio : options_.ratios) {
      view_bytes_.push_back(report_.raw_bytes / ratio);
      texture_bytes_.push_back(view_bytes_.back() - report_.geometry_bytes);
      if (texture_bytes_.back() <= 0)
        throw InputError("--ratios", "meshes alone take more than so little", "ask for lower ratios, or for larger pictures");
    }
  }

  void measure_ours(const Inference& separated) {
    std::optional<Inference> combined;
    progress_.begin("code", static_cast<int64_t>(texture_coders().size()), 0, "coders");
    for (const TextureCoder& coder : texture_coders()) {
      PartOfStep part(progress_);
      if (coder.layers == Layers::kCombined && !combined) combined = infer_combined(part);
      const Inference& inference = coder.layers == Layers::kCombined ? *combined : separated;
      report_.series.push_back(measure_coded_textures(scene_, inference, coder, store_, profile_, truth_, texture_bytes_, part));
      progress_.advance(1);
    }
    progress_.end();
  }

  Inference infer_combined(Progress& progress) {
    auto gpu = hal::create_osmesa_gpu(scene_.settings.width, scene_.settings.height);
    if (!gpu.ok()) throw InputError("OSMesa", gpu.status().detail(), "install the packages of tools/packages.txt");
    return infer_textures(scene_, combine_layers(scene_, frames_, store_, progress), store_, *gpu.value(),
                          inference_options(scene_, profile_.supersampling, profile_.filter), progress);
  }

  void measure_videos(const Inference& inference) {
    const std::vector<Contest> all = contests(options_.video_coders);
    progress_.begin("code as videos", static_cast<int64_t>(2 * all.size()), 0, "coders");
    std::vector<ViewVideos> views(all.size());
    tbb::parallel_for(size_t{0}, all.size(), [&](size_t i) {
      views[i] = measure_view_videos(scene_, truth_, *all[i].coder, all[i].access, view_bytes_, studio_, progress_);
      progress_.advance(1);
    });
    const std::vector<FieldSource> sources = field_sources(scene_, inference, store_);
    const TexturePictureSet textures(inference, sources, progress_);
    TextureDrawer drawer(scene_, inference, inference_options(scene_, profile_.supersampling, profile_.filter));
    for (size_t i = 0; i < all.size(); ++i) {
      report_.series.push_back(std::move(views[i].series));
      if (!all[i].coder->random.empty())
        report_.series.push_back(measure_texture_videos(scene_, textures, truth_, drawer, views[i].best, all[i].access,
                                                        texture_bytes_, studio_, progress_));
      progress_.advance(1);
    }
    progress_.end();
  }

  double inferred_psnr(const Inference& inference) {
    TextureDrawer drawer(scene_, inference, inference_options(scene_, profile_.supersampling, profile_.filter));
    double error = 0;
    for (size_t sample = 0; sample < truth_.size(); ++sample) {
      progress_.advance(0);
      const Picture picture = drawer.draw(static_cast<int64_t>(sample), [&](size_t field, int64_t own) {
        return load_field_texture(store_, inference.fields[field], own);
      });
      error += mean_squared_error(picture, truth_[sample]) / static_cast<double>(truth_.size());
    }
    return psnr_db(error);
  }

  // Charges textures for meshes, too.
  void finish(CompressionSeries& series) const {
    const double geometry = series.kind == CoderKind::kViewVideo ? 0 : report_.geometry_bytes;
    for (size_t i = 0; i < series.rows.size(); ++i) {
      CompressionRow& row = series.rows[i];
      row.bytes += geometry;
      row.ratio_target = options_.ratios[i];
      row.ratio = report_.raw_bytes / row.bytes;
    }
    for (RatePsnr& point : series.points) point.bytes += geometry;
    std::sort(series.points.begin(), series.points.end(), [](const RatePsnr& a, const RatePsnr& b) { return a.bytes < b.bytes; });
  }

  const Scene& scene_;
  const CompressionOptions& options_;
  Progress& progress_;
  Store store_;
  VideoStudio studio_;
  Profile profile_;
  std::vector<StoreKey> frames_;
  std::vector<Picture> truth_;  // by sample
  std::vector<double> view_bytes_, texture_bytes_;
  CompressionReport report_;
};

}  // namespace

CompressionLead lead_of(const CompressionReport& report, size_t target) {
  CompressionLead lead;
  double ours = 0;
  std::optional<double> random, mpeg4, av1;
  for (const CompressionSeries& series : report.series) {
    const CompressionRow& row = series.rows[target];
    const bool video = series.kind != CoderKind::kVitrine, is_random = row.decodes_per_access <= kRandomDecodes;
    if (!video && row.psnr_db > ours) ours = row.psnr_db, lead.best = series.coder;
    if (video && is_random) random = std::max(random.value_or(0), row.psnr_db);
    if (series.coder.starts_with("mpeg4")) mpeg4 = std::max(mpeg4.value_or(0), row.psnr_db);
    if (series.coder.starts_with("svt-av1") && !is_random) av1 = std::max(av1.value_or(0), row.psnr_db);
  }
  const auto ahead = [&](const std::optional<double>& theirs) { return theirs ? std::optional(ours - *theirs) : std::nullopt; };
  lead.random_access = ahead(random);
  lead.mpeg4_one_key = ahead(mpeg4);
  lead.av1_one_key = ahead(av1);
  return lead;
}

CompressionReport measure_compression(const Scene& scene, const CompressionOptions& options, const std::filesystem::path& work,
                                      Progress& progress) {
  if (options.videos) require_ffmpeg();
  return Contestants(scene, options, work, progress).run();
}

}  // namespace vitrine
