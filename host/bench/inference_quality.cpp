// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/inference_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "hal/backends.h"
#include "host/base/error.h"
#include "host/bench/forward_mapping.h"
#include "host/bench/frozen_scene.h"
#include "host/bench/object_pictures.h"
#include "host/bench/traced_textures.h"
#include "host/infer/geometry_states.h"
#include "host/infer/texture_store.h"
#include "host/infer/verification.h"
#include "host/verify/reference.h"

namespace vitrine {
namespace {

constexpr int kOwnSupersampling = 2;
constexpr uint32_t kSeed = 0, kOtherSeed = 1;

// Where textures are drawn, and what the tracer shows there.
struct Place {
  const char* where;
  const Scene* scene;  // frozen
  int width, height;
  uint32_t seed;
  Frame truth;
};

// The scene at the sample and between samples, and the places.
struct Setup {
  Scene at;
  std::unique_ptr<Scene> between;
  std::vector<Place> places;  // the first is "at", the second the same with another seed
};

TraceOptions trace_options(const Place& place, int samples) { return {place.width, place.height, samples, place.seed, true}; }

void trace_places(Setup& setup, int samples, Progress& progress) {
  progress.begin("trace", static_cast<int64_t>(setup.places.size()), 0, "pictures");
  PartOfStep part(progress);
  Tracer tracer(setup.at);
  const Position still = setup.at.space().position_of({});
  for (Place& place : setup.places) {
    if (place.scene == &setup.at) {
      place.truth = tracer.render(still, trace_options(place, samples), part);
    } else {
      Tracer moved(*place.scene);
      place.truth = moved.render(still, trace_options(place, samples), part);
    }
    progress.advance(1);
  }
  progress.end();
}

int scaled(int size, double scale) { return std::max(1, static_cast<int>(std::lround(size * scale))); }

std::unique_ptr<Setup> make_setup(const Scene& scene) {
  const Position sample = middle_position(scene);
  auto setup = std::make_unique<Setup>();
  setup->at = frozen_at(scene, sample);
  if (const auto position = half_step_on(scene, sample)) setup->between = std::make_unique<Scene>(frozen_at(scene, *position));
  const int width = scene.settings.width, height = scene.settings.height;
  setup->places.push_back({"at", &setup->at, width, height, kSeed, {}});
  setup->places.push_back({"other_seed", &setup->at, width, height, kOtherSeed, {}});
  if (setup->between) setup->places.push_back({"between", setup->between.get(), width, height, kSeed, {}});
  setup->places.push_back({"scale_0.75", &setup->at, scaled(width, 0.75), scaled(height, 0.75), kSeed, {}});
  setup->places.push_back({"scale_1.5", &setup->at, scaled(width, 1.5), scaled(height, 1.5), kSeed, {}});
  return setup;
}

GeometryState state_at(const Place& place, std::span<const DrawnObject> objects) {
  return geometry_state_at(*place.scene, 0, objects, static_cast<float>(place.width) / static_cast<float>(place.height));
}

InferenceOptions options_at(const Place& place, SurfaceFilter filter) {
  InferenceOptions options;
  options.width = place.width;
  options.height = place.height;
  options.supersampling = kOwnSupersampling;
  options.filter = filter;
  return options;
}

// How inference lays an object's textures out: in one state, all its layers alike.
Placement placement_of(const Inference& inference, size_t object) {
  for (const Field& field : inference.fields)
    if (field.drawn_object == static_cast<int>(object)) return {field.size(), field.maps.front()};
  return {};
}

constexpr std::array<uint8_t, 3> kPink = {255, 105, 180};
constexpr float kDetermined = 0.01f;  // pixels

TexturePictures texture_pictures(const std::string& object, const Field& field, const SolvedTexture& texture, float exposure) {
  Picture whole{field.texture_width, field.texture_height, {}}, determined = whole;
  for (int y = field.texture_height - 1; y >= 0; --y)
    for (int x = 0; x < field.texture_width; ++x) {
      const auto i = static_cast<size_t>(y) * static_cast<size_t>(field.texture_width) + static_cast<size_t>(x);
      for (size_t c = 0; c < 3; ++c) {
        const uint8_t code = srgb8_from_radiance(exposure * texture.texels[i][static_cast<int>(c)]);
        whole.rgb.push_back(code);
        determined.rgb.push_back(texture.precision[i] > kDetermined ? code : kPink[c]);
      }
    }
  return {object, field.layer, std::move(determined), std::move(whole)};
}

// Textures that do not depend on the filter, made anew only where the filter has changed how the domain is cut.
class PeerTextures {
 public:
  PeerTextures(const Place& at, int samples) : at_(at), samples_(samples), tracer_(*at.scene) {}

  void make(const Inference& inference, const std::vector<size_t>& measured, Progress& progress) {
    progress.begin("trace textures", static_cast<int64_t>(measured.size()), 0, "objects");
    std::vector<Made> made;
    for (const size_t i : measured) {
      const DrawnObject& object = inference.objects[i];
      const Placement placement = placement_of(inference, i);
      made.push_back(take(object.object, placement));
      if (made.back().forward.texels.empty())
        made.back() = make_one(object, placement, state_at(at_, inference.objects).clip_from_object[i], progress);
      progress.advance(1);
    }
    progress.end();
    made_ = std::move(made);
  }
  LaidTexture forward(size_t number) const { return {made_[number].forward, made_[number].placement.map}; }
  LaidTexture traced(size_t number) const { return {made_[number].traced, made_[number].placement.map}; }

 private:
  struct Made {
    int object = -1;
    Placement placement;
    LinearTexture forward, traced;
  };
  Made take(int object, const Placement& placement) {
    for (Made& made : made_)
      if (made.object == object && made.placement == placement) return std::move(made);
    return {};
  }
  Made make_one(const DrawnObject& object, const Placement& placement, const glm::mat4& clip_from_object,
                Progress& progress) const {
    const PartialPicture layers = object_layers(at_.truth, object.object, 1 / at_.scene->settings.exposure);
    const TextureTraceOptions options{at_.width, at_.height, samples_, kSeed};
    return {object.object, placement, map_forward(object, placement, clip_from_object, layers),
            tracer_.trace(object, placement, options, progress)};
  }

  const Place& at_;
  int samples_;
  TextureTracer tracer_;
  std::vector<Made> made_;
};

double psnr_of(const ObjectPicture& a, const ObjectPicture& b) {
  CodeError error;
  error.add(a, b);
  return error.psnr();
}

class Measurement {
 public:
  Measurement(const Scene& scene, const InferenceQualityOptions& options, const Store& store, Progress& progress)
      : scene_(scene), options_(options), store_(store), progress_(progress), setup_(make_setup(scene)) {
    only_ = find_named();
    auto gpu = hal::create_osmesa_gpu(scene.settings.width, scene.settings.height);
    if (!gpu.ok()) throw InputError("OSMesa", gpu.status().detail(), "install the packages of tools/packages.txt");
    gpu_ = std::move(gpu.value());
    trace_places(*setup_, options.samples_per_pixel, progress);
    const Place& at = setup_->places.front();
    key_ = frame_key(scene_key(*at.scene), *at.scene, {}, trace_options(at, options.samples_per_pixel));
    store.save_frame(key_, *at.scene, at.truth);
  }

  InferenceQuality run() {
    PeerTextures peers(setup_->places.front(), options_.samples_per_pixel);
    for (const SurfaceFilter filter : options_.filters) {
      const Place& at = setup_->places.front();
      const Inference inference = infer_textures(*at.scene, {key_}, store_, *gpu_, options_at(at, filter), progress_);
      const std::vector<size_t> measured = measured_of(inference.objects);
      if (options_.matrices) quality_.matrices.push_back({filter, measure_costs(at, filter, inference)});
      peers.make(inference, measured, progress_);
      if (quality_.objects.empty()) start_pictures(inference.objects, measured);
      if (filter == SurfaceFilter::kTrilinear)
        for (const size_t i : measured) show_textures(inference, i);
      for (const TextureMethod method : kTextureMethods) {
        std::vector<std::vector<LaidTexture>> textures;
        for (size_t n = 0; n < measured.size(); ++n) textures.push_back(textures_by(method, inference, measured[n], peers, n));
        for (const Place& place : setup_->places) draw_all(place, method, filter, inference.objects, measured, textures);
      }
    }
    return std::move(quality_);
  }

 private:
  float exposure() const { return scene_.settings.exposure; }

  // Index into Scene::objects, or -1 for all.
  int find_named() const {
    if (options_.object.empty()) return -1;
    std::string names;
    for (size_t o = 0; o < scene_.objects.size(); ++o) {
      if (scene_.objects[o].name == options_.object) return static_cast<int>(o);
      names += (o ? ", " : "") + scene_.objects[o].name;
    }
    throw InputError("--object " + options_.object, "the scene has no such object", "name one of " + names);
  }

  // Numbers of objects that count, among those that are drawn.
  std::vector<size_t> measured_of(std::span<const DrawnObject> objects) const {
    std::vector<size_t> measured;
    for (size_t i = 0; i < objects.size(); ++i) {
      const ObjectFrame* seen = find_object(setup_->places.front().truth, objects[i].object);
      if (seen && (only_ < 0 || objects[i].object == only_)) measured.push_back(i);
    }
    if (measured.empty())
      throw InputError(only_ < 0 ? scene_.file.string() : "--object " + options_.object,
                       "it is not seen in the middle of the axes", "move the camera, or name another object");
    return measured;
  }

  std::vector<LaidTexture> textures_by(TextureMethod method, const Inference& inference, size_t object, const PeerTextures& peers,
                                       size_t number) const {
    if (method == TextureMethod::kForward) return {peers.forward(number)};
    if (method == TextureMethod::kTraced) return {peers.traced(number)};
    return load_object_textures(store_, setup_->at, inference, kLayers, static_cast<int>(object), 0);
  }

  // Of a rendering in which every object has its textures' sizes and maps.
  std::vector<MatrixCost> measure_costs(const Place& at, SurfaceFilter filter, const Inference& inference) const {
    std::vector<TextureSize> sizes;
    GeometryState state = state_at(at, inference.objects);
    for (size_t i = 0; i < inference.objects.size(); ++i) {
      const Placement placement = placement_of(inference, i);
      sizes.push_back(placement.size);
      state.maps.push_back(placement.map);
    }
    return measure_matrix_costs(*gpu_, options_at(at, filter), inference.objects, sizes, state);
  }

  void start_pictures(std::span<const DrawnObject> objects, const std::vector<size_t>& measured) {
    for (const size_t i : measured) {
      const ObjectPicture truth = traced_object(setup_->places.front().truth, objects[i].object, exposure());
      const ObjectPicture other = in_window_of(traced_object(setup_->places[1].truth, objects[i].object, exposure()), truth);
      quality_.objects.push_back(
          {scene_.objects[static_cast<size_t>(objects[i].object)].name, psnr_of(truth, other), crop_of(truth), {}});
    }
  }

  void show_textures(const Inference& inference, size_t object) {
    const std::string& name = scene_.objects[static_cast<size_t>(inference.objects[object].object)].name;
    for (const Field& field : inference.fields)
      if (field.drawn_object == static_cast<int>(object))
        quality_.textures.push_back(texture_pictures(name, field, load_solved_texture(store_, field.textures.front()), exposure()));
  }

  void draw_all(const Place& place, TextureMethod method, SurfaceFilter filter, std::span<const DrawnObject> objects,
                const std::vector<size_t>& measured, const std::vector<std::vector<LaidTexture>>& textures) {
    ObjectDrawer drawer(*gpu_, options_at(place, filter), objects, state_at(place, objects));
    for (size_t n = 0; n < measured.size(); ++n) {
      progress_.advance(0);
      const int object = objects[measured[n]].object;
      const ObjectPicture truth = traced_object(place.truth, object, exposure());
      const ObjectPicture drawn = drawn_object(drawer.draw(measured[n], textures[n]), place.width, truth, exposure());
      quality_.rows.push_back(
          {method, filter, place.where, scene_.objects[static_cast<size_t>(object)].name, psnr_of(truth, drawn)});
      if (&place == &setup_->places.front()) quality_.objects[n].drawn.push_back({method, filter, crop_of(drawn)});
    }
  }

  const Scene& scene_;
  const InferenceQualityOptions& options_;
  const Store& store_;
  Progress& progress_;
  std::unique_ptr<Setup> setup_;
  int only_ = -1;
  std::unique_ptr<hal::Gpu> gpu_;
  StoreKey key_;
  InferenceQuality quality_;
};

}  // namespace

const char* method_name(TextureMethod method) {
  return method == TextureMethod::kLeastSquares ? "least_squares" : method == TextureMethod::kForward ? "forward" : "traced";
}

const char* filter_name(SurfaceFilter filter) {
  switch (filter) {
    case SurfaceFilter::kBilinear:
      return "bilinear";
    case SurfaceFilter::kTrilinear:
      return "trilinear";
    case SurfaceFilter::kAnisotropic2:
      return "aniso2";
    case SurfaceFilter::kAnisotropic4:
      return "aniso4";
  }
  return "trilinear";
}

InferenceQuality measure_inference(const Scene& scene, const InferenceQualityOptions& options, const Store& store,
                                   Progress& progress) {
  return Measurement(scene, options, store, progress).run();
}

}  // namespace vitrine
