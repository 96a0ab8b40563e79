// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Opening an image. Nothing in the file is believed before ImageView::open has returned ok: it verifies the header, the
// checksums of all sections, the directory, which it expands into memory of its own, and then every number in the directory
// against its range and against the others (formats/SPEC.md). After that the accessors below need no further checks. What stays
// untrusted are the coded bytes themselves: decoders (target/decode) check them as they run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "formats/block.h"
#include "formats/parameter_space.h"
#include "formats/rig.h"
#include "formats/status.h"
#include "formats/surface_filter.h"
#include "formats/texture_map.h"
#include "image_generated.h"

namespace vitrine {

inline constexpr char kImageMagic[8] = {'V', 'I', 'T', 'R', 'I', 'N', 'E', '\x1a'};
inline constexpr uint32_t kImageVersion = 1;  // written; the engine reads exactly kOldestImageVersion..kImageVersion
inline constexpr uint32_t kOldestImageVersion = 1;
inline constexpr size_t kSectionAlignment = 64;

// Nodes that an engine may hold half decoded at a time: what it needs scratch memory for.
inline constexpr size_t kNodesInDecoding = 16;

// Limits of one image; a reader refuses more (formats/SPEC.md gives the reasons).
inline constexpr uint32_t kMaxObjects = 4096, kMaxRigNodes = 65536, kMaxTextureSize = 8192, kMaxVertices = 1u << 24;
namespace limits {
inline constexpr uint32_t kIndices = 3u << 24, kRigTracks = 65536, kTrackKeys = 1u << 22, kFieldsPerObject = 8;
inline constexpr uint32_t kAxisSamples = 4096, kCodedNodes = 1u << 24, kNameBytes = 255, kPictureSize = 8192;
inline constexpr uint32_t kSupersampling = 4, kFrames = 1u << 20, kPathsPerPixel = 1u << 20;
inline constexpr uint32_t kMapsPerField = 1u << 16, kTextureMaps = 1u << 20;
inline constexpr float kTextureMapValue = 1e6f, kLength = 1e12f;
inline constexpr uint64_t kGridSamples = 1u << 24, kDirectoryBytes = 1u << 28, kUnits = uint64_t{1} << 40;
// What loading an image may ask for in all: caches, meshes, textures with their MIP levels, render targets.
inline constexpr uint64_t kEngineBytes = uint64_t{1} << 32;
}  // namespace limits

class ImageView {
 public:
  ImageView() = default;
  // `file` must stay mapped and unchanged for the life of the view and its copies, which share the expanded directory, and be
  // 64-byte aligned (a mapping is).
  static Result<ImageView> open(std::span<const std::byte> file);

  const fb::Image& directory() const { return *directory_; }
  std::span<const std::byte> section(uint32_t index) const;
  size_t file_bytes() const { return file_.size(); }
  uint32_t version() const { return version_; }
  ParameterSpace space() const;
  Camera camera() const;
  SurfaceFilter filter() const;
  FieldShape shape_of(const fb::Field& field) const;
  TextureMap map_of(const fb::Field& field, int block) const;  // how the textures of the block lie on the mesh

  // Rig, into the caller's arrays (sizes: directory().nodes()->size(), tracks()->size()). Spans point into the directory.
  void read_rig(std::span<RigNode> nodes, std::span<RigTrack> tracks) const;

 private:
  std::span<const std::byte> file_, sections_;
  std::shared_ptr<const std::byte[]> memory_;  // of the directory
  const fb::Image* directory_ = nullptr;
  uint32_t version_ = 0;
};

}  // namespace vitrine
