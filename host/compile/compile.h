// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The way of the data, wired: scene -> trace -> frames -> infer -> encode -> plan -> link. The only place that knows all
// stages. Every stage's product goes to the content-addressed store before the next one reads it, so a compile that was
// killed goes on where it was, and one that has nothing new to do only copies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/base/progress.h"
#include "host/encode/encode.h"
#include "host/frames/store.h"
#include "host/infer/inference.h"
#include "host/plan/plan.h"
#include "host/scene/scene.h"

namespace vitrine {

struct CompileOptions {
  std::filesystem::path image;   // written atomically
  std::filesystem::path work;    // the store
  std::string profile;           // empty: the scene's
  std::string storage;           // empty: the scene's; "150 KB/block", "384:1" or "12 MB"
};

struct CompileReport {
  uint64_t bytes = 0, raw_bytes = 0;       // raw: 24-bit RGB of all grid samples
  int64_t frames = 0, frames_rendered = 0;  // all that are traced; those that the store had not
  int64_t samples = 0;                      // of the grid
  double seconds = 0;
  double trace_seconds = 0, infer_seconds = 0, encode_seconds = 0;  // of the stages; what the store had takes next to none
  std::vector<std::string> warnings;       // one line each: what the profile does not provide for, ...
};

// Writes options.image. Throws InputError or Interrupted; then the image is untouched.
CompileReport compile_scene(const Scene& scene, const CompileOptions& options, Progress& progress);

// The parts that verification and benchmarks share.
TraceOptions trace_options(const Scene& scene);
std::vector<StoreKey> frame_keys(const Scene& scene);  // of all grid samples
// Traces what compile_scene would and the store lacks; returns how many frames that were. Throws Interrupted.
int64_t trace_missing(const Scene& scene, const Store& store, Progress& progress);
// One number for the frames of the grid; images carry it.
uint64_t frames_key(const std::vector<StoreKey>& keys);
InferenceOptions inference_options(const Scene& scene, int supersampling, SurfaceFilter filter = SurfaceFilter::kTrilinear);

// The inferred textures of a scene that was compiled with this store, or nothing where the store lacks its frames.
std::optional<Inference> find_inference(const Scene& scene, const Store& store, int supersampling, SurfaceFilter filter,
                                        Progress& progress);

// A texture of a field, `sample` flat in its own space, as the coder gets it. Throws InputError where the store has it no more.
CodedPlanes coded_texture(const Store& store, const Field& field, int64_t sample);
// The inferred fields as the coder takes them. They refer to `inference` and `store`.
std::vector<FieldSource> field_sources(const Scene& scene, const Inference& inference, const Store& store);
// As the scene asks for them to be coded, in so many bytes.
EncodeOptions encode_options(const Scene& scene, uint64_t target_bytes);

struct BuiltImage {
  std::vector<std::byte> bytes;
  std::vector<std::string> misfits;  // what the profile does not provide for
  uint64_t field_bytes = 0;          // EncodedField::bytes of all fields
};
// Plans and links. `encoded`: of field_sources(), in the same order.
BuiltImage build_image(const Scene& scene, const Inference& inference, const std::vector<EncodedField>& encoded,
                       const Profile& profile);

// Bytes of the whole image that a storage setting asks for. Throws InputError (named `source`) for one that says nothing.
// "N:1": raw bytes / N. "X KB/block": X times the number of 8-sample blocks of the grid. "X KB", "X MB": itself.
uint64_t storage_bytes(const std::string& storage, const Scene& scene, const std::string& source);

}  // namespace vitrine
