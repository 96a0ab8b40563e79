// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/inference_quality.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "hal/backends.h"
#include "host/base/error.h"
#include "host/bench/forward_mapping.h"
#include "host/bench/frozen_scene.h"
#include "host/bench/traced_textures.h"
#include "host/infer/geometry_states.h"
#include "host/infer/verification.h"
#include "host/verify/reference.h"

namespace vitrine {
namespace {

constexpr int kOwnSupersampling = 2;
constexpr float kCounts = 0.5f;  // coverage from which a pixel counts
constexpr uint8_t kGrey = 128;
constexpr int kCropMargin = 2;  // pixels
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

// The traced object in its window: 8-bit codes, and which pixels count.
struct Codes {
  int x = 0, y = 0, width = 0, height = 0;
  std::vector<uint8_t> rgb;
  std::vector<float> coverage;
};

const ObjectFrame* find_object(const Frame& frame, int object) {
  const auto found =
      std::find_if(frame.objects.begin(), frame.objects.end(), [&](const ObjectFrame& o) { return o.object == object; });
  return found == frame.objects.end() ? nullptr : &*found;
}

Codes traced_codes(const Frame& frame, int object, float exposure) {
  const ObjectFrame* o = find_object(frame, object);
  if (!o) return {};
  Codes codes{o->x, o->y, o->width, o->height, {}, o->coverage};
  for (size_t i = 0; i < o->coverage.size(); ++i)
    for (int c = 0; c < 3; ++c) codes.rgb.push_back(srgb8_from_radiance(exposure * (o->diffuse[i][c] + o->specular[i][c])));
  return codes;
}

// `picture`: the object's light times coverage, and coverage; of a whole picture `columns` wide.
Codes drawn_codes(const std::vector<glm::vec4>& picture, int columns, const Codes& window, float exposure) {
  Codes codes{window.x, window.y, window.width, window.height, {}, {}};
  for (int y = 0; y < window.height; ++y)
    for (int x = 0; x < window.width; ++x) {
      const glm::vec4& pixel =
          picture[static_cast<size_t>(window.y + y) * static_cast<size_t>(columns) + static_cast<size_t>(window.x + x)];
      codes.coverage.push_back(pixel.w);
      for (int c = 0; c < 3; ++c) codes.rgb.push_back(srgb8_from_radiance(pixel.w > 0 ? exposure * pixel[c] / pixel.w : 0));
    }
  return codes;
}

// Of equal windows.
double psnr_of(const Codes& a, const Codes& b) {
  double sum = 0;
  int64_t values = 0;
  for (size_t i = 0; i < std::min(a.coverage.size(), b.coverage.size()); ++i) {
    if (a.coverage[i] < kCounts || b.coverage[i] < kCounts) continue;
    for (size_t c = 3 * i; c < 3 * i + 3; ++c) sum += (a.rgb[c] - b.rgb[c]) * (a.rgb[c] - b.rgb[c]);
    values += 3;
  }
  return psnr_db(sum / static_cast<double>(std::max<int64_t>(1, values)));
}

// The window with a margin; grey where the object is not.
Picture crop_of(const Codes& codes) {
  Picture picture{codes.width + 2 * kCropMargin, codes.height + 2 * kCropMargin, {}};
  picture.rgb.assign(3 * static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height), kGrey);
  for (int y = 0; y < codes.height; ++y)
    for (int x = 0; x < codes.width; ++x) {
      const size_t from = static_cast<size_t>(y) * static_cast<size_t>(codes.width) + static_cast<size_t>(x);
      const size_t to =
          static_cast<size_t>(y + kCropMargin) * static_cast<size_t>(picture.width) + static_cast<size_t>(x + kCropMargin);
      if (codes.coverage[from] < kCounts) continue;
      for (size_t c = 0; c < 3; ++c) picture.rgb[3 * to + c] = codes.rgb[3 * from + c];
    }
  return picture;
}

// Frames as two windows see them need not be equal; what counts lies in both.
Codes in_window_of(const Codes& codes, const Codes& window) {
  Codes moved{window.x, window.y, window.width, window.height, {}, {}};
  for (int y = window.y; y < window.y + window.height; ++y)
    for (int x = window.x; x < window.x + window.width; ++x) {
      const bool inside = x >= codes.x && y >= codes.y && x < codes.x + codes.width && y < codes.y + codes.height;
      const size_t i =
          inside ? static_cast<size_t>(y - codes.y) * static_cast<size_t>(codes.width) + static_cast<size_t>(x - codes.x) : 0;
      moved.coverage.push_back(inside ? codes.coverage[i] : 0.0f);
      for (size_t c = 0; c < 3; ++c) moved.rgb.push_back(inside ? codes.rgb[3 * i + c] : uint8_t{0});
    }
  return moved;
}

// Draws single objects of one place through one filter, hidden by all others.
class ObjectDrawer {
 public:
  ObjectDrawer(hal::Gpu& gpu, const Place& place, SurfaceFilter filter, std::span<const DrawnObject> objects)
      : gpu_(gpu), place_(place), renderer_(gpu, options_at(place, filter), objects), state_(state_at(place, objects)) {
    const Pyramid pyramid(1, 1);
    const glm::vec4 nothing(0);
    const auto texels = std::as_bytes(std::span(&nothing, 1));
    clear_ = create_pyramid_texture(gpu, renderer_.drawer(), pyramid, hal::TextureFormat::kRgba32f, texels);
  }
  ~ObjectDrawer() { gpu_.destroy(clear_); }
  ObjectDrawer(const ObjectDrawer&) = delete;
  ObjectDrawer& operator=(const ObjectDrawer&) = delete;

  // Its light times its coverage, and its coverage, rows top first: black and clear textures leave the others' shapes alone.
  std::vector<glm::vec4> draw(size_t object, const std::vector<LaidTexture>& textures) {
    std::vector<std::vector<SurfaceTexture>> surfaces(state_.mirrored.size(), {{clear_, {}}});
    surfaces[object].clear();
    for (const LaidTexture& laid : textures)
      surfaces[object].push_back(
          {upload_texture(gpu_, renderer_.drawer(), laid.texture, hal::TextureFormat::kRgba32f), laid.map});
    std::vector<glm::vec4> samples(static_cast<size_t>(renderer_.width()) * static_cast<size_t>(renderer_.height()));
    renderer_.render_surfaces(state_, surfaces, samples);
    for (const SurfaceTexture& surface : surfaces[object]) gpu_.destroy(surface.texture);
    return resolve_linear(samples, place_.width, place_.height, kOwnSupersampling);
  }

 private:
  hal::Gpu& gpu_;
  const Place& place_;
  TestRenderer renderer_;
  GeometryState state_;
  hal::Texture clear_;
};

// How inference lays an object's textures out: in one state, all its layers alike.
Placement placement_of(const Inference& inference, size_t object) {
  for (const Field& field : inference.fields)
    if (field.drawn_object == static_cast<int>(object)) return {field.size(), field.maps.front()};
  return {};
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
      quality_.matrices.push_back({filter, measure_costs(at, filter, inference)});
      peers.make(inference, measured, progress_);
      if (quality_.objects.empty()) start_pictures(inference.objects, measured);
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
  MatrixCosts measure_costs(const Place& at, SurfaceFilter filter, const Inference& inference) const {
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
      const Codes truth = traced_codes(setup_->places.front().truth, objects[i].object, exposure());
      const Codes other = in_window_of(traced_codes(setup_->places[1].truth, objects[i].object, exposure()), truth);
      quality_.objects.push_back(
          {scene_.objects[static_cast<size_t>(objects[i].object)].name, psnr_of(truth, other), crop_of(truth), {}});
    }
  }

  void draw_all(const Place& place, TextureMethod method, SurfaceFilter filter, std::span<const DrawnObject> objects,
                const std::vector<size_t>& measured, const std::vector<std::vector<LaidTexture>>& textures) {
    ObjectDrawer drawer(*gpu_, place, filter, objects);
    for (size_t n = 0; n < measured.size(); ++n) {
      progress_.advance(0);
      const int object = objects[measured[n]].object;
      const Codes truth = traced_codes(place.truth, object, exposure());
      const Codes drawn = drawn_codes(drawer.draw(measured[n], textures[n]), place.width, truth, exposure());
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
