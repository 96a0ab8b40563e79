// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/verify/verify.h"

#include <algorithm>
#include <cmath>

#include "hal/backends.h"
#include "host/base/error.h"
#include "host/infer/verification.h"
#include "host/verify/positions.h"
#include "host/verify/reference.h"
#include "host/verify/still_player.h"

namespace vitrine {
namespace {

ObjectError object_error(const std::string& name, const std::vector<int>& pixels, const Picture& a, const Picture& b) {
  ObjectError error{name, 0, static_cast<int64_t>(pixels.size()) * 3};
  for (const int pixel : pixels) {
    for (int c = 0; c < 3; ++c) {
      const double difference = a.rgb[3 * static_cast<size_t>(pixel) + c] - b.rgb[3 * static_cast<size_t>(pixel) + c];
      error.squared_error += difference * difference;
    }
  }
  return error;
}

// What the uncoded textures of the nearest grid sample show: the loss of inference alone.
Picture inferred_picture(const Scene& scene, const Inference& inference, const Store& store, hal::Gpu& gpu,
                         const ImageView& image, const Position& position) {
  InferenceOptions options;
  options.width = scene.settings.width;
  options.height = scene.settings.height;
  options.supersampling = static_cast<int>(image.directory().supersampling());
  options.filter = image.filter();
  const ParameterSpace space = scene.space();
  Picture picture{options.width, options.height, {}};
  const int64_t sample = space.flat_from_index(space.nearest_sample(position));
  for (const glm::vec3& radiance : draw_inferred(store, scene, inference, kLayers, options, gpu, sample))
    for (int c = 0; c < 3; ++c) picture.rgb.push_back(srgb8_from_radiance(radiance[c] * scene.settings.exposure));
  return picture;
}

std::vector<ObjectError> object_errors(const Scene& scene, const Reference& reference, const Picture& picture, const Picture& truth) {
  std::vector<ObjectError> errors;
  for (size_t o = 0; o < scene.objects.size(); ++o)
    if (const std::vector<int>& pixels = reference.pixels_of_object()[o]; !pixels.empty())
      errors.push_back(object_error(scene.objects[o].name, pixels, picture, truth));
  return errors;
}

}  // namespace

double psnr_db(double mean_squared_error) {
  return mean_squared_error <= 0 ? 99.0 : std::min(99.0, 10 * std::log10(255.0 * 255.0 / mean_squared_error));
}

double mean_squared_error(const Picture& a, const Picture& b) {
  double sum = 0;
  for (size_t i = 0; i < a.rgb.size(); ++i) sum += (a.rgb[i] - b.rgb[i]) * (a.rgb[i] - b.rgb[i]);
  return sum / static_cast<double>(std::max<size_t>(1, a.rgb.size()));
}

Verification verify_image(const ImageView& image, const Scene& scene, const Store& store, const Inference* inference,
                          const VerifyOptions& options, Progress& progress) {
  auto gpu = hal::create_osmesa_gpu(scene.settings.width, scene.settings.height);
  if (!gpu.ok()) throw InputError("OSMesa", gpu.status().detail(), "install the packages of tools/packages.txt");
  StillPlayer player(image, *gpu.value());
  Tracer tracer(scene);
  const ParameterSpace space = scene.space();

  Verification result;
  result.bytes = image.file_bytes();
  result.raw_bytes = static_cast<uint64_t>(3) * scene.settings.width * scene.settings.height * space.sample_count();
  const auto add = [&](const char* kind, const std::vector<Position>& positions) {
    for (const Position& position : positions) {
      Comparison comparison;
      comparison.kind = kind;
      comparison.position = position;
      result.comparisons.push_back(std::move(comparison));
    }
  };
  add("at", positions_at(space, options.at));
  add("between", positions_between(space, options.between));
  add("off", positions_off(space, options.off));

  const double margin = std::pow(10, options.noise_margin_db / 10);
  progress.begin("verify", static_cast<int64_t>(result.comparisons.size()), 0, "references");
  for (Comparison& comparison : result.comparisons) {
    comparison.played = player.play(comparison.position);
    Reference reference(scene, store, tracer, comparison.position);
    PartOfStep part(progress);
    do {
      reference.refine(part);
      comparison.truth = reference.picture();
      comparison.squared_error = mean_squared_error(comparison.played, comparison.truth);
      comparison.noise = reference.noise();
    } while (comparison.noise * margin > comparison.squared_error && reference.paths_per_pixel() < options.max_paths);
    comparison.paths_per_pixel = reference.paths_per_pixel();
    if (inference && comparison.kind == "at") {
      comparison.inferred = inferred_picture(scene, *inference, store, *gpu.value(), image, comparison.position);
      comparison.inferred_squared_error = mean_squared_error(*comparison.inferred, comparison.truth);
      comparison.inferred_objects = object_errors(scene, reference, *comparison.inferred, comparison.truth);
    }
    comparison.objects = object_errors(scene, reference, comparison.played, comparison.truth);
    progress.advance(1);
  }
  progress.end();
  return result;
}

}  // namespace vitrine
