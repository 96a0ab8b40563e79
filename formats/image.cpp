// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/image.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <new>

#include "formats/compressed.h"
#include "formats/directory_checks.h"
#include "formats/image_header.h"

namespace vitrine {
namespace {

static_assert(std::endian::native == std::endian::little, "tracks and node tables are read in place");
static_assert(static_cast<int>(fb::AxisKind::periodic) == static_cast<int>(AxisKind::kPeriodic) &&
              static_cast<int>(fb::AxisKind::discrete) == static_cast<int>(AxisKind::kDiscrete) &&
              static_cast<int>(fb::TrackPath::rotation) == static_cast<int>(TrackPath::kRotation) &&
              static_cast<int>(fb::TrackPath::scale) == static_cast<int>(TrackPath::kScale) &&
              static_cast<int>(fb::Interpolation::linear) == static_cast<int>(Interpolation::kLinear) &&
              static_cast<int>(fb::Interpolation::cubic_spline) == static_cast<int>(Interpolation::kCubicSpline) &&
              static_cast<int>(fb::SurfaceFilter::bilinear) == static_cast<int>(SurfaceFilter::kBilinear) &&
              static_cast<int>(fb::SurfaceFilter::trilinear) == static_cast<int>(SurfaceFilter::kTrilinear) &&
              static_cast<int>(fb::SurfaceFilter::anisotropic2) == static_cast<int>(SurfaceFilter::kAnisotropic2) &&
              static_cast<int>(fb::SurfaceFilter::anisotropic4) == static_cast<int>(SurfaceFilter::kAnisotropic4));

using Bytes = std::span<const std::byte>;

// Nesting in the schema is 4 deep; the count covers the limits of image.h.
constexpr flatbuffers::uoffset_t kMaxDepth = 64;
constexpr flatbuffers::uoffset_t kMaxTables =
    kMaxRigNodes + limits::kRigTracks + kMaxObjects * (1 + limits::kFieldsPerObject) + kMaxAxes + 3;

using DirectoryMemory = std::shared_ptr<const std::byte[]>;

Result<DirectoryMemory> expand_directory(Bytes packed, const ImageHeader& header) {
  if (header.directory_plain_bytes > limits::kDirectoryBytes) return Status{StatusCode::kMalformed, "the directory is too large"};
  if (checksum_of(packed) != header.directory_checksum) return Status{StatusCode::kChecksumMismatch, "the directory is damaged"};
  std::byte* plain = new (std::nothrow) std::byte[header.directory_plain_bytes];
  if (!plain) return Status{StatusCode::kOutOfMemory, "there is no memory for the directory"};
  DirectoryMemory memory(plain);
  if (Status status = expand(packed, {plain, header.directory_plain_bytes}); !status.ok()) return status;
  return memory;
}

Result<const fb::Image*> read_directory(Bytes bytes) {
  flatbuffers::Verifier verifier(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), kMaxDepth, kMaxTables);
  if (!fb::VerifyImageBuffer(verifier)) return Status{StatusCode::kMalformed, "the directory is not well formed"};
  const fb::Image* image = fb::GetImage(bytes.data());
  // The verifier sees to the alignment of a vector's length, not of its elements.
  const auto& sections = *image->sections();
  if (sections.size() > 0 && reinterpret_cast<uintptr_t>(sections.Data()) % alignof(fb::Section) != 0)
    return Status{StatusCode::kMalformed, "the section table is not aligned"};
  return image;
}

bool all_zero(Bytes bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte{0}; });
}

// What follows the directory and the zeros behind it.
Result<Bytes> sections_of(Bytes file, uint64_t directory_end) {
  const uint64_t begin = aligned_offset(directory_end);
  if (begin > file.size()) return Status{StatusCode::kMalformed, "the file ends behind its directory"};
  if (!all_zero(file.subspan(directory_end, begin - directory_end)))
    return Status{StatusCode::kMalformed, "the bytes behind the directory are not zero"};
  return file.subspan(begin);
}

// Each section begins where the one before it ended, rounded up to the alignment, and zeros fill the gaps: so no two overlap
// and every byte of the file is accounted for. `file`: from the first section on.
Status check_layout(Bytes file, const fb::Image& image) {
  uint64_t end = 0;
  for (const fb::Section* section : *image.sections()) {
    const uint64_t begin = aligned_offset(end);
    if (section->kind() > fb::SectionKind::MAX) return {StatusCode::kMalformed, "a section is of an unknown kind"};
    if (section->offset() != begin) return {StatusCode::kMalformed, "a section is not where it must be"};
    if (begin > file.size() || section->size() > file.size() - begin)
      return {StatusCode::kMalformed, "a section does not lie in the file"};
    if (!all_zero(file.subspan(end, begin - end))) return {StatusCode::kMalformed, "the bytes between sections are not zero"};
    end = begin + section->size();
  }
  if (aligned_offset(end) != file.size() || !all_zero(file.subspan(end)))
    return {StatusCode::kMalformed, "the last section does not end the file"};
  return {};
}

Status check_checksums(Bytes file, const fb::Image& image) {
  for (const fb::Section* section : *image.sections())
    if (checksum_of(file.subspan(section->offset(), section->size())) != section->checksum())
      return {StatusCode::kChecksumMismatch, "a section is damaged"};
  return {};
}

glm::vec3 vector_or(const fb::Vec3* v, const glm::vec3& absent) { return v ? glm::vec3(v->x(), v->y(), v->z()) : absent; }

RigNode node_from_directory(const fb::RigNode& node) {
  RigNode result;
  result.parent = node.parent();
  result.translation = vector_or(node.translation(), glm::vec3(0));
  result.scale = vector_or(node.scale(), glm::vec3(1));
  if (const fb::Quat* r = node.rotation()) result.rotation = glm::quat(r->w(), r->x(), r->y(), r->z());
  if (const auto* m = node.matrix())
    for (uint32_t i = 0; i < 16; ++i) result.matrix[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = m->Get(i);
  return result;
}

RigTrack track_from_directory(const fb::RigTrack& track) {
  RigTrack result;
  result.node = track.node();
  result.axis = track.axis();
  result.path = static_cast<TrackPath>(track.path());
  result.interpolation = static_cast<Interpolation>(track.interpolation());
  result.positions = {track.positions()->data(), track.positions()->size()};
  result.values = {track.values()->data(), track.values()->size()};
  return result;
}

}  // namespace

Result<ImageView> ImageView::open(std::span<const std::byte> file) {
  if (reinterpret_cast<uintptr_t>(file.data()) % kSectionAlignment != 0)
    return Status{StatusCode::kUnsupported, "the image is not mapped at a multiple of 64 bytes"};
  const Result<ImageHeader> header = read_header(file);
  if (!header.ok()) return header.status();
  const Bytes packed = file.subspan(kHeaderBytes, header.value().directory_bytes);
  const Result<DirectoryMemory> memory = expand_directory(packed, header.value());
  if (!memory.ok()) return memory.status();
  const Result<const fb::Image*> directory = read_directory({memory.value().get(), header.value().directory_plain_bytes});
  if (!directory.ok()) return directory.status();
  const fb::Image& image = *directory.value();
  const Result<Bytes> sections = sections_of(file, kHeaderBytes + packed.size());
  if (!sections.ok()) return sections.status();
  if (Status status = check_layout(sections.value(), image); !status.ok()) return status;
  if (Status status = check_checksums(sections.value(), image); !status.ok()) return status;
  if (Status status = check_directory(image); !status.ok()) return status;
  ImageView view;
  view.file_ = file;
  view.sections_ = sections.value();
  view.memory_ = memory.value();
  view.directory_ = &image;
  view.version_ = header.value().version;
  return view;
}

std::span<const std::byte> ImageView::section(uint32_t index) const {
  const fb::Section& section = *directory_->sections()->Get(index);
  return sections_.subspan(section.offset(), section.size());
}

ParameterSpace ImageView::space() const { return space_from_directory(*directory_); }

Camera ImageView::camera() const {
  const fb::Camera& camera = *directory_->camera();
  Camera result;
  result.node = static_cast<int32_t>(camera.node());
  result.perspective = camera.perspective();
  result.yfov = camera.yfov();
  result.ymag = camera.ymag();
  result.near_distance = camera.near_distance();
  result.far_distance = camera.far_distance();
  return result;
}

FieldShape ImageView::shape_of(const fb::Field& field) const { return shape_from_directory(*directory_, field); }

SurfaceFilter ImageView::filter() const { return static_cast<SurfaceFilter>(directory_->filter()); }

TextureMap ImageView::map_of(const fb::Field& field, int block) const {
  const auto* of_blocks = field.block_maps();
  const uint32_t map = of_blocks && of_blocks->size() > 0 ? of_blocks->Get(static_cast<uint32_t>(block)) : 0;
  const uint32_t patches = field.patches();
  TextureMap result;
  result.patch_count = static_cast<int>(patches);
  for (uint32_t patch = 0; patch < kMaxPatches; ++patch) {
    std::array<float, kTextureMapValues> values;
    const uint32_t first = kTextureMapValues * (patches * map + std::min(patch, patches - 1));
    for (uint32_t i = 0; i < kTextureMapValues; ++i) values[i] = field.maps()->Get(first + i);
    result.patches[patch] = PatchMap::from(values);
  }
  return result;
}

void ImageView::read_rig(std::span<RigNode> nodes, std::span<RigTrack> tracks) const {
  for (uint32_t i = 0; i < nodes.size(); ++i) nodes[i] = node_from_directory(*directory_->nodes()->Get(i));
  for (uint32_t i = 0; i < tracks.size(); ++i) tracks[i] = track_from_directory(*directory_->tracks()->Get(i));
}

}  // namespace vitrine
