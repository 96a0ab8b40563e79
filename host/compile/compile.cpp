// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/compile/compile.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <numeric>

#include "formats/color.h"
#include "formats/companding.h"
#include "hal/backends.h"
#include "hal/storage.h"
#include "host/base/error.h"
#include "host/base/output_file.h"
#include "host/encode/encode.h"
#include "host/infer/fields.h"
#include "host/infer/verification.h"
#include "host/link/link.h"
#include "host/plan/plan.h"
#include "host/scene/deformation.h"

namespace vitrine {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Over how many pictures a layer that does not depend on the view is averaged. Only in steps of half an octave, so that an axis
// that grows a little leaves the frames that there are as they are.
int views_averaged(const Scene& scene) {
  constexpr int kMostViews = 64;
  const AxisMask axes = only_camera_axes(scene);
  double views = 1;
  for (size_t a = 0; a < scene.axes.size(); ++a)
    if (axes >> a & 1) views *= scene.axes[a].shape.samples;
  int counted = 1;
  for (int step = 1; counted < kMostViews && std::exp2(0.5 * step) <= views; ++step)
    counted = static_cast<int>(std::exp2(0.5 * step));
  return counted;
}

// The target draws rigid meshes.
void check_rigid(const Scene& scene) {
  for (size_t o = 0; o < scene.objects.size(); ++o) {
    const AxisMask axes = deforming_axes(scene, static_cast<int>(o));
    if (axes == 0) continue;
    const std::string& axis = scene.axes[static_cast<size_t>(std::countr_zero(axes))].name;
    throw InputError(scene.file.string(),
                     "axis \"" + axis + "\" deforms object \"" + scene.objects[o].name +
                         "\" (morph targets or a skin), but an image holds rigid meshes only",
                     "leave the axis out, animate nodes without a skin instead, or render stills (vitrine render SCENE --at " +
                         axis + "=0.5 -o still.png)");
  }
}

struct TracedFrame {
  Position position{};
  StoreKey key;
};

std::vector<TracedFrame> frames_at(const Scene& scene, const std::vector<Position>& positions) {
  const StoreKey base = scene_key(scene);
  std::vector<TracedFrame> frames;
  for (const Position& position : positions) frames.push_back({position, frame_key(base, scene, position, trace_options(scene))});
  return frames;
}

std::vector<Position> grid_positions(const Scene& scene) {
  const ParameterSpace space = scene.space();
  std::vector<Position> positions;
  for (int64_t i = 0; i < space.sample_count(); ++i) positions.push_back(space.position_of(space.index_from_flat(i)));
  return positions;
}

// Those of the grid, and those between where the scene asks for them: as infer_textures takes them.
std::vector<TracedFrame> traced_frames(const Scene& scene) {
  std::vector<Position> positions = grid_positions(scene);
  if (scene.settings.between)
    for (const BetweenSample& between : between_samples(scene)) positions.push_back(between.position);
  return frames_at(scene, positions);
}

std::vector<StoreKey> keys_of(const std::vector<TracedFrame>& frames) {
  std::vector<StoreKey> keys;
  for (const TracedFrame& frame : frames) keys.push_back(frame.key);
  return keys;
}

int64_t render_missing(const Scene& scene, const std::vector<TracedFrame>& frames, const Store& store, Progress& progress) {
  std::vector<TracedFrame> missing;
  for (const TracedFrame& frame : frames)
    if (!store.has_frame(frame.key)) missing.push_back(frame);
  const auto total = static_cast<int64_t>(frames.size());
  progress.begin("trace", total, total - static_cast<int64_t>(missing.size()), "frames");
  if (!missing.empty()) {
    Tracer tracer(scene);
    for (const TracedFrame& frame : missing) {
      PartOfStep part(progress);
      store.save_frame(frame.key, scene, tracer.render(frame.position, trace_options(scene), part));
      progress.advance(1);
    }
  }
  progress.end();
  return static_cast<int64_t>(missing.size());
}

Inference infer(const Scene& scene, const std::vector<StoreKey>& keys, const Store& store, const InferenceOptions& options,
                Progress& progress) {
  auto gpu = hal::create_osmesa_gpu(scene.settings.width, scene.settings.height);
  if (!gpu.ok()) throw InputError("OSMesa", gpu.status().detail(), "install the packages of tools/packages.txt");
  return infer_textures(scene, keys, store, *gpu.value(), options, progress);
}

// A linear texture as the coder wants it: companded codes in Y, Co, Cg.
CodedPlanes coded_planes(const LinearTexture& texture) {
  const size_t texels = texture.texels.size();
  CodedPlanes planes(3 * texels);
  for (size_t i = 0; i < texels; ++i) {
    const glm::vec3& radiance = texture.texels[i];
    const Ycocg c =
        ycocg_from_rgb({code_from_radiance(radiance.r), code_from_radiance(radiance.g), code_from_radiance(radiance.b)});
    planes[i] = static_cast<int16_t>(c.y);
    planes[texels + i] = static_cast<int16_t>(c.co);
    planes[2 * texels + i] = static_cast<int16_t>(c.cg);
  }
  return planes;
}

FieldSource field_source(const Scene& scene, const Inference& inference, int number, const Store& store) {
  const Field& field = inference.fields[number];
  FieldSource source;
  source.space = field.space;
  source.width = field.texture_width;
  source.height = field.texture_height;
  source.importance = field.importance;
  source.object = field.drawn_object;
  source.weight = scene.objects[static_cast<size_t>(inference.objects[static_cast<size_t>(field.drawn_object)].object)].weight;
  source.block_maps = field.block_maps;
  source.block_size = field.block_size;
  source.stagger = field.stagger;
  source.samples_shown = static_cast<double>(scene.space().sample_count()) / static_cast<double>(field.space.sample_count());
  source.load = [&store, &field](int64_t sample) { return coded_texture(store, field, sample); };
  return source;
}

// What an image holds beside the coded fields: meshes, and about what was seen of rigs and directories. build_to_size corrects
// it; a little too much saves it from coding everything again.
uint64_t expected_overhead(const Inference& inference) {
  constexpr uint64_t kRigAndDirectory = 1024, kObject = 128, kField = 320;
  uint64_t bytes = kRigAndDirectory + kField * inference.fields.size();
  for (const DrawnObject& object : inference.objects) bytes += kObject + mesh_section(object).bytes.size();
  return bytes;
}

// An image of at most `bytes`, and at least 98.5 % of them where the fields have that much to say.
BuiltImage build_to_size(const Scene& scene, const Inference& inference, const Store& store, const Profile& profile,
                         uint64_t bytes, Progress& progress) {
  const std::vector<FieldSource> sources = field_sources(scene, inference, store);
  constexpr int kAttempts = 3;
  int64_t overhead = static_cast<int64_t>(expected_overhead(inference));
  for (int attempt = 1;; ++attempt) {
    const auto for_fields =
        static_cast<uint64_t>(std::max(static_cast<int64_t>(bytes) - overhead, static_cast<int64_t>(bytes / 16)));
    BuiltImage image =
        build_image(scene, inference, encode_fields(sources, encode_options(scene, for_fields), progress), profile);
    const bool fits = image.bytes.size() <= bytes, full = image.bytes.size() * 1000 >= bytes * 985;
    const bool satisfied = image.field_bytes * 1000 < for_fields * 985;  // the fields had no more to say
    if (fits && (full || satisfied || attempt >= kAttempts)) return image;
    if (attempt >= kAttempts) {
      throw InputError(
          scene.file.string(),
          "the image needs " + std::to_string(image.bytes.size()) + " bytes, storage allows " + std::to_string(bytes),
          "allow more storage, or lower resolution_scale");
    }
    overhead = static_cast<int64_t>(image.bytes.size()) - static_cast<int64_t>(image.field_bytes) + 64;
  }
}

void write_image(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
  const Status status = hal::write_file_atomically(path.c_str(), bytes);
  if (!status.ok()) throw InputError(path.string(), status.detail(), "check that the folder exists and has room");
}

}  // namespace

TraceOptions trace_options(const Scene& scene) {
  TraceOptions options;
  options.width = scene.settings.width;
  options.height = scene.settings.height;
  options.samples_per_pixel = scene.settings.samples_per_pixel;
  options.noise_db = static_cast<double>(scene.settings.noise_db);
  options.views = views_averaged(scene);
  return options;
}

std::vector<StoreKey> frame_keys(const Scene& scene) { return keys_of(frames_at(scene, grid_positions(scene))); }

int64_t trace_missing(const Scene& scene, const Store& store, Progress& progress) {
  return render_missing(scene, traced_frames(scene), store, progress);
}

uint64_t frames_key(const std::vector<StoreKey>& keys) {
  KeyBuilder all;
  for (const StoreKey& key : keys) all.text(key.hex());
  return all.finish().low;
}

InferenceOptions inference_options(const Scene& scene, int supersampling, SurfaceFilter filter) {
  InferenceOptions options;
  options.width = scene.settings.width;
  options.height = scene.settings.height;
  options.supersampling = supersampling;
  options.filter = filter;
  options.axis_smoothing = scene.settings.smoothing;
  return options;
}

std::optional<Inference> find_inference(const Scene& scene, const Store& store, int supersampling, SurfaceFilter filter,
                                        Progress& progress) {
  const std::vector<StoreKey> keys = keys_of(traced_frames(scene));
  for (const StoreKey& key : keys)
    if (!store.has_frame(key)) return std::nullopt;
  return infer(scene, keys, store, inference_options(scene, supersampling, filter), progress);
}

CodedPlanes coded_texture(const Store& store, const Field& field, int64_t sample) {
  return coded_planes(load_field_texture(store, field, sample));
}

std::vector<FieldSource> field_sources(const Scene& scene, const Inference& inference, const Store& store) {
  std::vector<FieldSource> sources;
  for (size_t f = 0; f < inference.fields.size(); ++f)
    sources.push_back(field_source(scene, inference, static_cast<int>(f), store));
  return sources;
}

EncodeOptions encode_options(const Scene& scene, uint64_t target_bytes) {
  EncodeOptions options;
  options.coder = scene.settings.codec;
  options.worst_object = static_cast<double>(scene.settings.worst_object);
  options.target_bytes = target_bytes;
  return options;
}

BuiltImage build_image(const Scene& scene, const Inference& inference, const std::vector<EncodedField>& encoded,
                       const Profile& profile) {
  std::vector<PlannedField> planned;
  for (size_t f = 0; f < encoded.size(); ++f)
    planned.push_back(
        {inference.fields[f].axes, &encoded[f], inference.fields[f].texture_width, inference.fields[f].texture_height});
  std::vector<float> speeds;
  for (const Axis& axis : scene.axes) speeds.push_back(axis.max_speed);

  LinkInput input;
  input.scene = &scene;
  input.width = scene.settings.width;
  input.height = scene.settings.height;
  input.supersampling = profile.supersampling;
  input.filter = profile.filter;
  input.frames_key = frames_key(frame_keys(scene));
  input.inference = &inference;
  input.encoded = &encoded;
  input.plan = make_plan(scene.space(), speeds, planned, scene.settings.interpolate, profile);
  BuiltImage image{link_image(input), misfits(input.plan, profile), 0};
  for (const EncodedField& field : encoded) image.field_bytes += field.bytes();
  return image;
}

CompileReport compile_scene(const Scene& scene, const CompileOptions& options, Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  if (options.image.extension() != ".vit")
    throw InputError(options.image.string(), "it is not the name of an image", "write -o NAME.vit");
  check_output_file(options.image);
  if (scene.axes.empty())
    throw InputError(scene.file.string(), "there is no [[axis]]", "add one (vitrine new shows how), or use vitrine render");
  check_rigid(scene);
  const Profile profile = options.profile.empty() ? load_profile(scene.settings.profile, scene.file.string() + ": target.profile")
                                                  : load_profile(options.profile);
  const std::string storage = options.storage.empty() ? scene.settings.storage : options.storage;
  const uint64_t bytes = storage_bytes(storage, scene, options.storage.empty() ? scene.file.string() : "--storage");
  const Store store(options.work);

  const std::vector<TracedFrame> frames = traced_frames(scene);
  CompileReport report;
  report.frames = static_cast<int64_t>(frames.size());
  report.raw_bytes = static_cast<uint64_t>(3) * scene.settings.width * scene.settings.height * scene.space().sample_count();
  report.samples = scene.space().sample_count();
  const auto trace_start = std::chrono::steady_clock::now();
  report.frames_rendered = render_missing(scene, frames, store, progress);
  report.trace_seconds = seconds_since(trace_start);

  const auto infer_start = std::chrono::steady_clock::now();
  const Inference inference =
      infer(scene, keys_of(frames), store, inference_options(scene, profile.supersampling, profile.filter), progress);
  report.infer_seconds = seconds_since(infer_start);
  const auto encode_start = std::chrono::steady_clock::now();
  BuiltImage built = build_to_size(scene, inference, store, profile, bytes, progress);
  report.encode_seconds = seconds_since(encode_start);
  write_image(options.image, built.bytes);
  report.warnings = inference.warnings;
  report.warnings.insert(report.warnings.end(), built.misfits.begin(), built.misfits.end());
  report.bytes = built.bytes.size();
  report.seconds = seconds_since(start);
  return report;
}

}  // namespace vitrine
