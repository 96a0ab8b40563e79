// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Any bytes as an image whose checksums are right, so that what lies behind them is reached: the header's, those of sections and
// the directory's are made to fit. What opens is then read as an engine does: rig, meshes, blocks and pyramids, nodes.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "formats/context_changes.h"
#include "formats/image.h"
#include "formats/image_header.h"
#include "formats/mesh.h"
#include "host/link/image_writer.h"
#include "target/field_state.h"

namespace vitrine {
namespace {

constexpr int kMostNodes = 16;              // decoded of a field
constexpr uint64_t kMostUnits = 2'000'000;  // of a node
constexpr size_t kMostTexels = 1 << 20;

// The checksum is a section's last number.
void seal(const fb::Section& section, uint64_t checksum) {
  auto* end = const_cast<uint8_t*>(reinterpret_cast<const uint8_t*>(&section + 1));
  std::memcpy(end - sizeof(checksum), &checksum, sizeof(checksum));
}

// The input: bytes of the directory (32), then the directory as it is before compression, then what lies behind it.
std::vector<std::byte> sealed(std::span<const std::byte> input) {
  uint32_t directory_bytes;
  std::memcpy(&directory_bytes, input.data(), sizeof(directory_bytes));
  input = input.subspan(sizeof(directory_bytes));
  const auto end = input.begin() + static_cast<ptrdiff_t>(std::min<size_t>(directory_bytes, input.size()));
  const std::vector<std::byte> directory(input.begin(), end);
  std::vector<std::byte> behind(end, input.end());
  behind.resize(aligned_offset(behind.size()));
  flatbuffers::Verifier verifier(reinterpret_cast<const uint8_t*>(directory.data()), directory.size());
  if (verifier.VerifyBuffer<fb::Image>(nullptr))
    for (const fb::Section* section : *fb::GetImage(directory.data())->sections())
      if (section->offset() <= behind.size() && section->size() <= behind.size() - section->offset())
        seal(*section, checksum_of(std::span(behind).subspan(section->offset(), section->size())));
  return write_file(directory, {{fb::SectionKind::mesh, behind}}, kFastCompression);
}

void decode(const FieldState& field, uint32_t node, uint64_t offset, uint32_t size) {
  std::vector<int16_t> planes(kNodePlanes * field.texels());
  const NodeDesc desc = field.desc_of(node);
  NodeDecoder decoder;
  if (!decoder.start(desc, field.coded.subspan(offset, size), planes).ok()) return;
  for (uint64_t spent = 0; !decoder.done() && spent < kMostUnits;) {
    const auto step = decoder.step(1);
    if (!step.ok()) return;
    spent += step.value();
    if (spent > desc.units) std::abort();
  }
}

void read_field(const ImageView& image, const fb::Field& coded) {
  FieldState field = describe_field(image, coded, {});
  const std::span<const uint8_t> built_in = default_context_bytes(field.coder());
  std::vector<uint8_t> contexts(static_cast<size_t>(field.shape.pyramid.level_count) * built_in.size());
  if (!expand_contexts(context_changes_of(coded), built_in, contexts).ok()) std::abort();  // an open image has good ones
  field.contexts = contexts;
  for (int block = 0; block < field.shape.block_count(); ++block) (void)image.map_of(coded, block);
  for (int64_t sample = 0; sample < std::min<int64_t>(field.shape.space.sample_count(), 4096); ++sample) {
    const GridIndex at = field.shape.space.index_from_flat(sample);
    (void)field.shape.block_of(at);
    for (int level = 0; level < field.shape.pyramid.level_count; ++level) {
      const int node = field.shape.node_of(at, level);
      if (node < 0 || node >= field.shape.node_count() || field.shape.level_of(node) != level) std::abort();
    }
  }
  uint64_t offset = 0;
  int decoded = 0;
  for (uint32_t node = 0; node < coded.node_bytes()->size() && decoded < kMostNodes; ++node) {
    const uint32_t size = coded.node_bytes()->Get(node);
    (void)field.shape.samples_of(static_cast<int>(node));
    if (size > 0 && field.texels() <= kMostTexels) decode(field, node, offset, size), ++decoded;
    offset += size;
  }
}

void read_object(const ImageView& image, const fb::Object& object) {
  std::vector<MeshVertex> vertices(object.vertex_count());
  std::vector<uint32_t> indices(object.index_count());
  (void)decode_mesh(image, object, vertices, indices);
  for (const fb::Field* field : *object.fields()) read_field(image, *field);
}

void read(const ImageView& image) {
  std::vector<RigNode> nodes(image.directory().nodes()->size());
  std::vector<RigTrack> tracks(image.directory().tracks()->size());
  image.read_rig(nodes, tracks);
  std::vector<glm::mat4> matrices(nodes.size());
  evaluate_rig({nodes, tracks}, {}, matrices);
  for (const fb::Object* object : *image.directory().objects()) read_object(image, *object);
}

}  // namespace
}  // namespace vitrine

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace vitrine;
  if (size < sizeof(uint32_t)) return 0;
  const AlignedBytes file(sealed({reinterpret_cast<const std::byte*>(data), size}));
  const auto image = ImageView::open(file.bytes());
  if (image.ok()) read(image.value());
  return 0;
}
