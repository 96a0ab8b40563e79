// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/base/output_file.h"
#include "host/bench/inference_quality.h"
#include "tools/commands/commands.h"
#include "tools/commands/contact_sheet.h"
#include "tools/commands/print_json.h"
#include "tools/commands/scene_input.h"
#include "tools/commands/work_folder.h"

namespace vitrine {
namespace {

constexpr SurfaceFilter kShownFilters[] = {SurfaceFilter::kTrilinear, SurfaceFilter::kAnisotropic4};
constexpr int kSheetHeight = 240;  // of one picture on the sheet, about: smaller ones are magnified

nlohmann::json json_of(SurfaceFilter filter, const MatrixCost& cost) {
  // JSON knows no infinity: readers that disagree about which samples show what.
  return {{"filter", filter_name(filter)},
          {"method", cost.method},
          {"renderings", cost.renderings},
          {"milliseconds", cost.milliseconds},
          {"difference", std::isfinite(cost.difference) ? nlohmann::json(cost.difference) : nlohmann::json()},
          {"rendering_difference", cost.rendering_difference},
          {"row_sum_error", cost.row_sum_error}};
}

nlohmann::json json_of(const InferenceQuality& quality) {
  nlohmann::json rows = nlohmann::json::array(), matrices = nlohmann::json::array(), noise = nlohmann::json::object();
  for (const QualityRow& r : quality.rows)
    rows.push_back({{"method", method_name(r.method)},
                    {"filter", filter_name(r.filter)},
                    {"where", r.where},
                    {"object", r.object},
                    {"psnr_db", r.psnr_db}});
  for (const auto& [filter, costs] : quality.matrices)
    for (const MatrixCost& cost : costs) matrices.push_back(json_of(filter, cost));
  for (const ObjectPictures& o : quality.objects) noise[o.object] = o.noise_db;
  return {{"bench", "inference"}, {"rows", rows}, {"matrices", matrices}, {"noise_db", noise}};
}

std::vector<SurfaceFilter> filters_of(const InferenceQuality& quality) {
  std::vector<SurfaceFilter> filters;
  for (const QualityRow& r : quality.rows)
    if (std::find(filters.begin(), filters.end(), r.filter) == filters.end()) filters.push_back(r.filter);
  return filters;
}

// Rows of one object as a table: a line for each method and filter, a column for each place.
void print_object(const InferenceQuality& quality, const ObjectPictures& object) {
  std::vector<std::string> places;
  for (const QualityRow& r : quality.rows)
    if (std::find(places.begin(), places.end(), r.where) == places.end()) places.push_back(r.where);
  fmt::print("{} (two seeds at the sample agree to {:.2f} dB)\n  {:<14} {:<10}", object.object, object.noise_db, "PSNR, dB",
             "filter");
  for (const std::string& place : places) fmt::print(" {:>10}", place);
  for (const TextureMethod method : kTextureMethods)
    for (const SurfaceFilter filter : filters_of(quality)) {
      fmt::print("\n  {:<14} {:<10}", method_name(method), filter_name(filter));
      for (const QualityRow& r : quality.rows)
        if (r.object == object.object && r.method == method && r.filter == filter) fmt::print(" {:>10.2f}", r.psnr_db);
    }
  fmt::print("\n");
}

void print_matrices(const InferenceQuality& quality) {
  fmt::print("rendering matrices A of a view; the largest differences\n  {:<14} {:<10} {:>10} {:>9} {:>16} {:>16} {:>11}",
             "read by", "filter", "renderings", "ms", "from identifiers", "A x - rendering", "row sum - 1");
  for (const auto& [filter, costs] : quality.matrices)
    for (const MatrixCost& cost : costs)
      fmt::print("\n  {:<14} {:<10} {:>10} {:>9.1f} {:>16.1e} {:>16.1e} {:>11.1e}", cost.method, filter_name(filter),
                 cost.renderings, cost.milliseconds, static_cast<double>(cost.difference),
                 static_cast<double>(cost.rendering_difference), static_cast<double>(cost.row_sum_error));
  fmt::print("\n");
}

Picture padded(const Picture& picture, int width, int height) {
  Picture large{width, height, std::vector<uint8_t>(3 * static_cast<size_t>(width) * static_cast<size_t>(height), 255)};
  for (int y = 0; y < picture.height; ++y)
    std::copy_n(picture.rgb.begin() + static_cast<ptrdiff_t>(y) * picture.width * 3, picture.width * 3,
                large.rgb.begin() + static_cast<ptrdiff_t>(y) * width * 3);
  return large;
}

// Two rows an object: through each shown filter, ground truth and the three methods.
void write_method_sheet(const std::string& file, const InferenceQuality& quality) {
  int width = 0, height = 0;
  for (const ObjectPictures& o : quality.objects)
    width = std::max(width, o.truth.width), height = std::max(height, o.truth.height);
  const int factor = std::max(1, kSheetHeight / height);
  const auto prepared = [&](const Picture& picture) { return magnified(padded(picture, width, height), factor); };
  std::vector<std::vector<Picture>> rows;
  for (const ObjectPictures& o : quality.objects)
    for (const SurfaceFilter filter : kShownFilters) {
      rows.push_back({prepared(o.truth)});
      for (const auto& drawn : o.drawn)
        if (drawn.filter == filter) rows.back().push_back(prepared(drawn.picture));
    }
  write_picture_rows(file, rows);
}

// A row a texture.
void write_texture_sheet(const std::string& file, const InferenceQuality& quality) {
  int width = 0, height = 0;
  for (const TexturePictures& t : quality.textures)
    width = std::max(width, t.whole.width), height = std::max(height, t.whole.height);
  std::vector<std::vector<Picture>> rows;
  for (const TexturePictures& t : quality.textures)
    rows.push_back({padded(t.determined, width, height), padded(t.whole, width, height)});
  write_picture_rows(file, rows);
}

}  // namespace

void BenchInferenceCommand::run() const {
  for (const std::string& file : {sheet, textures})
    if (!file.empty()) check_output_file(file);
  const auto jobs = limit_jobs(common);
  const auto progress = make_progress(common);
  const auto loaded = load_scene_with(scene, common, [&](Scene& s) { apply_size(s, size); });
  const WorkFolder folder("");
  const InferenceQuality quality =
      measure_inference(*loaded, {.samples_per_pixel = samples_per_pixel, .object = object, .matrices = matrices}, Store(folder.path()), *progress);
  if (!sheet.empty()) write_method_sheet(sheet, quality);
  if (!textures.empty()) write_texture_sheet(textures, quality);
  if (common.json) return print_json(json_of(quality));
  for (const ObjectPictures& o : quality.objects) print_object(quality, o);
  if (matrices) print_matrices(quality);
}

}  // namespace vitrine
