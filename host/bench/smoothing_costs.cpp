// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/smoothing_costs.h"

#include <string>

#include "hal/storage.h"
#include "host/base/error.h"
#include "host/compile/compile.h"
#include "host/verify/verify.h"

namespace vitrine {
namespace {

constexpr VerifyOptions kReferences{.at = 2, .between = 2, .off = 2};

double psnr_of(const Verification& verification, const std::string& kind, double Comparison::*error) {
  double sum = 0;
  int count = 0;
  for (const Comparison& comparison : verification.comparisons)
    if (comparison.kind == kind) sum += comparison.*error, ++count;
  return count ? psnr_db(sum / count) : 0;
}

}  // namespace

std::vector<SmoothingRow> measure_smoothing(const Scene& scene, std::span<const float> strengths,
                                            const std::filesystem::path& work, Progress& progress) {
  std::vector<SmoothingRow> rows;
  const Store store(work);
  Scene smoothed = scene;
  for (const float strength : strengths) {
    smoothed.settings.smoothing = strength;
    CompileOptions options;
    options.image = work / "smoothed.vit";
    options.work = work;
    const CompileReport report = compile_scene(smoothed, options, progress);
    const auto file = hal::MappedFile::open(options.image.c_str());
    if (!file.ok()) throw InputError(options.image.string(), file.status().detail(), "check that the folder has room");
    const auto image = ImageView::open(file.value().bytes());
    if (!image.ok()) throw InputError(options.image.string(), image.status().detail(), "compile it again");
    const fb::Image& directory = image.value().directory();
    const auto inference =
        find_inference(smoothed, store, static_cast<int>(directory.supersampling()), image.value().filter(), progress);
    const Verification verification =
        verify_image(image.value(), smoothed, store, inference ? &*inference : nullptr, kReferences, progress);
    rows.push_back({strength, report.bytes, psnr_of(verification, "at", &Comparison::inferred_squared_error),
                    psnr_of(verification, "at", &Comparison::squared_error),
                    psnr_of(verification, "between", &Comparison::squared_error),
                    psnr_of(verification, "off", &Comparison::squared_error)});
  }
  return rows;
}

}  // namespace vitrine
