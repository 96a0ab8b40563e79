// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/node_pictures.h"

#include <string>
#include <utility>

#include "formats/context_changes.h"
#include "host/base/error.h"
#include "host/compile/compile.h"
#include "host/encode/block_cells.h"
#include "target/field_state.h"

namespace vitrine {
namespace {

CodedPlanes decoded(const NodePicture& node) {
  CodedPlanes planes(kNodePlanes * node.texels());
  NodeDecoder decoder;
  Status status = decoder.start(node.desc, node.bytes, planes);
  while (status.ok() && !decoder.done()) status = decoder.step(~uint64_t{0}).status();
  if (!status.ok()) throw InputError("the image", status.detail(), "compile it again");
  return planes;
}

std::vector<uint8_t> contexts_of(const fb::Field& field) {
  std::vector<uint8_t> contexts(field.level_steps()->size() / 3 * kContextBytesPerLevel);
  const Status status = expand_contexts(context_changes_of(field), default_context_bytes(), contexts);
  if (!status.ok()) throw InputError("the image", status.detail(), "compile it again");
  return contexts;
}

// Where each node's bytes begin in the field's section.
std::vector<uint64_t> node_offsets(const fb::Field& field) {
  std::vector<uint64_t> offsets{0};
  for (const uint32_t size : *field.node_bytes()) offsets.push_back(offsets.back() + size);
  return offsets;
}

// The nodes of a block that have bytes, level by level: what each should show is what the coarser ones leave.
void add_nodes(const FieldState& field, int block, std::vector<CodedPlanes> leaves, std::vector<NodePicture>& pictures) {
  const std::vector<uint64_t> offsets = node_offsets(*field.field);
  for (int level = 0; level < field.shape.pyramid.level_count; ++level)
    for (const BlockCell& cell : cells_of_level(field.shape, block, level)) {
      const auto node = static_cast<uint32_t>(block * field.nodes_per_block + cell.node);
      const uint32_t size = field.field->node_bytes()->Get(node);
      if (size == 0) continue;
      pictures.push_back({field.desc_of(node), field.coded.subspan(offsets[node], size), mixed_leaves(leaves, cell)});
      take_off_leaves(decoded(pictures.back()), cell, leaves);
    }
}

void check_same_field(const fb::Field& coded, const Field& field) {
  if (coded.layer()->str() != field.layer || static_cast<int>(coded.texture_width()) != field.texture_width ||
      static_cast<int>(coded.texture_height()) != field.texture_height)
    throw InputError("the image", "its textures are not those of the scene",
                     "name the scene and the work folder that it was compiled from");
}

// In the order in which they are linked.
std::vector<const Field*> fields_of(const Inference& inference) {
  std::vector<const Field*> fields;
  for (int object = 0; object < static_cast<int>(inference.objects.size()); ++object)
    for (const Field& field : inference.fields)
      if (field.drawn_object == object) fields.push_back(&field);
  return fields;
}

}  // namespace

NodePictures node_pictures(const ImageView& image, const Inference& inference, const Store& store, Progress& progress) {
  std::vector<const fb::Field*> coded;
  for (const fb::Object* object : *image.directory().objects())
    for (const fb::Field* field : *object->fields()) coded.push_back(field);
  const std::vector<const Field*> fields = fields_of(inference);
  if (coded.size() != fields.size())
    throw InputError("the image", "it has other fields than the scene",
                     "name the scene and the work folder that it was compiled from");
  NodePictures pictures;
  progress.begin("finding the pictures of nodes", static_cast<int64_t>(fields.size()), 0, "fields");
  for (size_t f = 0; f < fields.size(); ++f) {
    check_same_field(*coded[f], *fields[f]);
    FieldState state = describe_field(image, *coded[f], {});
    state.contexts = pictures.contexts.emplace_back(contexts_of(*coded[f]));
    for (int block = 0; block < state.shape.block_count(); ++block) {
      std::vector<CodedPlanes> leaves;
      for (const GridIndex& sample : samples_of_block(state.shape, block))
        leaves.push_back(coded_texture(store, *fields[f], state.shape.space.flat_from_index(sample)));
      add_nodes(state, block, std::move(leaves), pictures.nodes);
    }
    progress.advance(1);
  }
  progress.end();
  return pictures;
}

}  // namespace vitrine
