// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/node_pictures.h"

#include <cmath>
#include <string>

#include "host/base/error.h"
#include "host/compile/compile.h"
#include "target/field_state.h"

namespace vitrine {
namespace {

// The samples in a node's cell, flat.
std::vector<int64_t> samples_of(const FieldShape& shape, int node) {
  std::vector<int64_t> samples;
  const FieldShape::Box box = shape.samples_of(node);
  for (int64_t flat = 0; flat < shape.space.sample_count(); ++flat) {
    const GridIndex at = shape.space.index_from_flat(flat);
    bool inside = true;
    for (size_t a = 0; a < static_cast<size_t>(shape.space.axis_count); ++a)
      inside &= at[a] >= box.first[a] && at[a] <= box.last[a];
    if (inside) samples.push_back(flat);
  }
  return samples;
}

CodedPlanes mean_of(const std::vector<CodedPlanes>& rest, const std::vector<int64_t>& samples) {
  CodedPlanes mean(rest[0].size());
  const double count = static_cast<double>(samples.size());
  for (size_t i = 0; i < mean.size(); ++i) {
    double sum = 0;
    for (const int64_t sample : samples) sum += rest[static_cast<size_t>(sample)][i];
    mean[i] = static_cast<int16_t>(std::floor(sum / count + 0.5));
  }
  return mean;
}

CodedPlanes decoded(const NodePicture& node) {
  CodedPlanes planes(kNodePlanes * node.texels());
  NodeDecoder decoder;
  Status status = decoder.start(node.desc, node.bytes, planes);
  while (status.ok() && !decoder.done()) status = decoder.step(~uint64_t{0}).status();
  if (!status.ok()) throw InputError("the image", status.detail(), "compile it again");
  return planes;
}

// Every node in order: levels of a block come from coarse to fine.
void add_nodes(const FieldState& field, std::vector<CodedPlanes>& rest, std::vector<NodePicture>& pictures) {
  uint64_t offset = 0;
  for (uint32_t node = 0; node < field.field->node_bytes()->size(); ++node) {
    const uint32_t size = field.field->node_bytes()->Get(node);
    if (size == 0) continue;
    const std::vector<int64_t> samples = samples_of(field.shape, static_cast<int>(node));
    pictures.push_back({field.desc_of(node), field.coded.subspan(offset, size), mean_of(rest, samples)});
    offset += size;
    const CodedPlanes shown = decoded(pictures.back());
    for (const int64_t sample : samples)
      for (size_t i = 0; i < shown.size(); ++i)
        rest[static_cast<size_t>(sample)][i] = static_cast<int16_t>(rest[static_cast<size_t>(sample)][i] - shown[i]);
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

std::vector<NodePicture> node_pictures(const ImageView& image, const Inference& inference, const Store& store,
                                       Progress& progress) {
  std::vector<const fb::Field*> coded;
  for (const fb::Object* object : *image.directory().objects())
    for (const fb::Field* field : *object->fields()) coded.push_back(field);
  const std::vector<const Field*> fields = fields_of(inference);
  if (coded.size() != fields.size())
    throw InputError("the image", "it has other fields than the scene",
                     "name the scene and the work folder that it was compiled from");
  std::vector<NodePicture> pictures;
  progress.begin("finding the pictures of nodes", static_cast<int64_t>(fields.size()), 0, "fields");
  for (size_t f = 0; f < fields.size(); ++f) {
    check_same_field(*coded[f], *fields[f]);
    std::vector<CodedPlanes> rest;
    for (int64_t sample = 0; sample < fields[f]->space.sample_count(); ++sample)
      rest.push_back(coded_texture(store, *fields[f], sample));
    add_nodes(describe_field(image, *coded[f], {}), rest, pictures);
    progress.advance(1);
  }
  progress.end();
  return pictures;
}

}  // namespace vitrine
