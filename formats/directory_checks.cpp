// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "formats/directory_checks.h"

#include <cmath>
#include <string_view>

#include "formats/context_changes.h"
#include "formats/image.h"
#include "formats/mesh.h"
#include "formats/node_coder.h"
#include "formats/rig.h"
#include "formats/spiht_coding.h"
#include "formats/text.h"

namespace vitrine {
namespace {

Status malformed(const char* detail) { return {StatusCode::kMalformed, detail}; }

std::string_view text_of(const flatbuffers::String& string) { return {string.c_str(), string.size()}; }
bool valid_name(const flatbuffers::String& name) { return name.size() <= limits::kNameBytes && is_plain_text(text_of(name)); }

// Quadratic, over at most kMaxObjects names of limits::kNameBytes: below a tenth of a second at the very worst, and needs no
// memory.
template <typename Table, typename NameOf>
bool names_are_unique(const flatbuffers::Vector<flatbuffers::Offset<Table>>& tables, NameOf name_of) {
  for (uint32_t i = 1; i < tables.size(); ++i)
    for (uint32_t j = 0; j < i; ++j)
      if (text_of(*name_of(*tables.Get(i))) == text_of(*name_of(*tables.Get(j)))) return false;
  return true;
}

bool in_range(float value, float low, float high) { return value >= low && value <= high; }  // false for NaN

// Large enough for any scene in metres, small enough that products of a few stay finite.
constexpr float kMaxCoordinate = 1e9f;
bool sensible(float value) { return in_range(value, -kMaxCoordinate, kMaxCoordinate); }

template <typename Vec>
bool sensible_vector(const Vec* v) {
  return !v || (sensible(v->x()) && sensible(v->y()) && sensible(v->z()));
}

// Readers make rotations unit; what must be refused is what cannot be.
bool near_unit(float x, float y, float z, float w) { return in_range(x * x + y * y + z * z + w * w, 0.5f, 2.0f); }

Status check_axis(const fb::Axis& axis) {
  if (!valid_name(*axis.name())) return malformed("an axis has no proper name");
  if (axis.kind() > fb::AxisKind::MAX) return malformed("an axis is of an unknown kind");
  if (axis.samples() < 1 || axis.samples() > limits::kAxisSamples)
    return malformed("an axis has an impossible number of samples");
  if (!in_range(axis.max_speed(), 0, limits::kAxisSamples)) return malformed("an axis has an impossible greatest speed");
  return {};
}

Status check_axes(const fb::Image& image) {
  if (image.axes()->size() > kMaxAxes) return malformed("there are too many axes");
  uint64_t samples = 1;
  for (const fb::Axis* axis : *image.axes()) {
    if (Status status = check_axis(*axis); !status.ok()) return status;
    samples *= axis->samples();
  }
  if (samples > limits::kGridSamples) return malformed("the grid has too many samples");
  if (!names_are_unique(*image.axes(), [](const fb::Axis& axis) { return axis.name(); }))
    return malformed("two axes have one name");
  return {};
}

Status check_picture(const fb::Image& image) {
  if (image.producer() && !valid_name(*image.producer())) return malformed("the producer is not plain text");
  if (image.width() < 1 || image.width() > limits::kPictureSize || image.height() < 1 || image.height() > limits::kPictureSize)
    return malformed("the picture has an impossible size");
  if (image.supersampling() < 1 || image.supersampling() > limits::kSupersampling)
    return malformed("the supersampling is impossible");
  if (image.paths_per_pixel() > limits::kPathsPerPixel) return malformed("the paths per pixel are impossible");
  if (!in_range(image.noise_db(), 0.0f, 1000.0f)) return malformed("the noise is impossible");
  if (!in_range(image.exposure(), 1e-6f, 1e6f)) return malformed("the exposure is impossible");
  if (image.filter() > fb::SurfaceFilter::MAX) return malformed("the filter of surfaces is unknown");
  return {};
}

Status check_node(const fb::RigNode& node, uint32_t index) {
  if (node.parent() < -1 || node.parent() >= static_cast<int64_t>(index)) return malformed("a rig node stands before its parent");
  if (!sensible_vector(node.translation()) || !sensible_vector(node.scale())) return malformed("a rig node is not finite");
  if (const fb::Quat* r = node.rotation(); r && !near_unit(r->x(), r->y(), r->z(), r->w()))
    return malformed("a rig node's rotation is not of unit length");
  if (!node.matrix()) return {};
  if (node.matrix()->size() != 16) return malformed("a rig node's matrix has not 16 entries");
  for (const float entry : *node.matrix())
    if (!sensible(entry)) return malformed("a rig node is not finite");
  return {};
}

Status check_track_keys(const flatbuffers::Vector<float>& positions) {
  float previous = -1;
  for (const float position : positions) {
    if (!in_range(position, 0, 1)) return malformed("a track has keys outside of its axis");
    if (position <= previous) return malformed("a track's keys do not ascend");
    previous = position;
  }
  return {};
}

Status check_track_values(const fb::RigTrack& track) {
  const bool rotation = track.path() == fb::TrackPath::rotation,
             spline = track.interpolation() == fb::Interpolation::cubic_spline;
  const uint32_t width = rotation ? 4 : 3, parts = spline ? 3 : 1;
  const flatbuffers::Vector<float>& values = *track.values();
  if (values.size() != track.positions()->size() * width * parts) return malformed("a track has not one value per key");
  for (const float value : values)
    if (!sensible(value)) return malformed("a track's value is not finite");
  if (!rotation) return {};
  for (uint32_t i = spline ? width : 0; i < values.size(); i += width * parts)
    if (!near_unit(values[i], values[i + 1], values[i + 2], values[i + 3]))
      return malformed("a track's rotation is not of unit length");
  return {};
}

Status check_track(const fb::Image& image, const fb::RigTrack& track, uint64_t& keys) {
  if (track.node() >= image.nodes()->size()) return malformed("a track moves a node that does not exist");
  if (track.axis() >= image.axes()->size()) return malformed("a track follows an axis that does not exist");
  if (track.path() > fb::TrackPath::MAX || track.interpolation() > fb::Interpolation::MAX)
    return malformed("a track is of an unknown kind");
  keys += track.positions()->size();
  if (track.positions()->size() < 1 || keys > limits::kTrackKeys) return malformed("a track has an impossible number of keys");
  if (Status status = check_track_keys(*track.positions()); !status.ok()) return status;
  return check_track_values(track);
}

Status check_rig(const fb::Image& image) {
  if (image.nodes()->size() > kMaxRigNodes || image.tracks()->size() > limits::kRigTracks)
    return malformed("the rig is too large");
  for (uint32_t i = 0; i < image.nodes()->size(); ++i)
    if (Status status = check_node(*image.nodes()->Get(i), i); !status.ok()) return status;
  uint64_t keys = 0;
  for (const fb::RigTrack* track : *image.tracks())
    if (Status status = check_track(image, *track, keys); !status.ok()) return status;
  return {};
}

Status check_camera(const fb::Image& image) {
  const fb::Camera& camera = *image.camera();
  if (camera.node() >= image.nodes()->size()) return malformed("the camera is on a node that does not exist");
  if (camera.perspective() && !in_range(camera.yfov(), 1e-4f, 3.1415f))
    return malformed("the camera's field of view is impossible");
  if (!camera.perspective() && !in_range(camera.ymag(), 1e-6f, kMaxCoordinate))
    return malformed("the camera's magnification is impossible");
  const float lowest = camera.perspective() ? 1e-9f : -kMaxCoordinate;
  if (!in_range(camera.near_distance(), lowest, kMaxCoordinate) || !in_range(camera.far_distance(), lowest, kMaxCoordinate) ||
      camera.near_distance() >= camera.far_distance())
    return malformed("the camera's near and far distances are impossible");
  return {};
}

Status check_plan(const fb::Plan& plan) {
  if (plan.units_budget() < 1 || plan.units_budget() > limits::kUnits || plan.units_worst() > limits::kUnits)
    return malformed("the plan's units are impossible");
  if (plan.upload_worst() > limits::kEngineBytes || plan.cache_bytes() > limits::kEngineBytes)
    return malformed("the plan asks for too much memory");
  if (plan.settle_frames() > limits::kFrames || plan.horizon_frames() > limits::kFrames)
    return malformed("the plan's frames are impossible");
  return {};
}

// Objects and fields name the sections one after another: the k-th reference is to section k. So each is used once, and the
// order in the file is the order of use.
class SectionCursor {
 public:
  explicit SectionCursor(const flatbuffers::Vector<const fb::Section*>& sections) : sections_(sections) {}
  bool take(uint32_t index, fb::SectionKind kind) {
    return index == next_ && index < sections_.size() && sections_.Get(next_++)->kind() == kind;
  }
  bool exhausted() const { return next_ == sections_.size(); }

 private:
  const flatbuffers::Vector<const fb::Section*>& sections_;
  uint32_t next_ = 0;
};

class ObjectChecker {
 public:
  explicit ObjectChecker(const fb::Image& image) : image_(image), sections_(*image.sections()) {}

  Status check_all() {
    const auto& objects = *image_.objects();
    if (objects.size() > kMaxObjects) return malformed("there are too many objects");
    for (const fb::Object* object : objects)
      if (Status status = check_object(*object); !status.ok()) return status;
    if (!names_are_unique(objects, [](const fb::Object& object) { return object.name(); }))
      return malformed("two objects have one name");
    if (!sections_.exhausted()) return malformed("there is a section that nothing uses");
    return check_memory();
  }

 private:
  Status check_object(const fb::Object& object) {
    if (!valid_name(*object.name())) return malformed("an object has no proper name");
    if (object.representation() > fb::Representation::MAX)
      return {StatusCode::kUnsupported, "an object is of an unknown representation"};
    if (object.node() >= image_.nodes()->size()) return malformed("an object is on a node that does not exist");
    if (Status status = check_mesh(object); !status.ok()) return status;
    return check_fields(object);
  }

  Status check_mesh(const fb::Object& object) {
    const uint32_t vertices = object.vertex_count(), indices = object.index_count(), culled = object.culled_index_count();
    if (vertices < 1 || vertices > kMaxVertices) return malformed("an object has an impossible number of vertices");
    if (indices < 3 || indices > limits::kIndices || indices % 3 != 0)
      return malformed("an object has an impossible number of indices");
    if (culled > indices || culled % 3 != 0) return malformed("an object has an impossible number of single-sided indices");
    if (!sections_.take(object.mesh(), fb::SectionKind::mesh))
      return malformed("an object's mesh is not in the section that it must be in");
    if (object.coded_vertex_bytes() > coded_vertex_bound(vertices) ||
        object.coded_index_bytes() > coded_index_bound(indices, vertices))
      return malformed("an object's mesh is of an impossible size");
    memory_ += uint64_t{2} * (sizeof(MeshVertex) * vertices + sizeof(uint32_t) * indices);
    return check_grid(object);
  }

  static Status check_grid(const fb::Object& object) {
    const fb::Vec3& origin = *object.grid_origin();
    for (const float value : {origin.x(), origin.y(), origin.z(), object.grid_step()})
      if (!in_range(value, -limits::kLength, limits::kLength)) return malformed("an object's grid of vertices is impossible");
    return {};
  }

  Status check_fields(const fb::Object& object) {
    const auto& fields = *object.fields();
    if (fields.size() > limits::kFieldsPerObject) return malformed("an object has too many fields");
    for (const fb::Field* field : fields)
      if (Status status = check_field(*field); !status.ok()) return status;
    if (!names_are_unique(fields, [](const fb::Field& field) { return field.layer(); }))
      return malformed("two fields of an object are of one layer");
    return {};
  }

  Status check_field(const fb::Field& field) {
    if (!valid_name(*field.layer())) return malformed("a field has no proper layer name");
    if (field.axes() >> image_.axes()->size() != 0) return malformed("a field depends on an axis that does not exist");
    if (field.coder() > fb::NodeCoder::MAX) return {StatusCode::kUnsupported, "a field is coded by an unknown coder"};
    if (Status status = check_texture(field); !status.ok()) return status;
    if (Status status = check_maps(field); !status.ok()) return status;
    if (Status status = check_shape(field); !status.ok()) return status;
    if (!sections_.take(field.nodes(), fb::SectionKind::nodes))
      return malformed("a field's nodes are not in the section that they must be in");
    if (Status status = check_contexts(field); !status.ok()) return status;
    if (Status status = check_nodes(field); !status.ok()) return status;
    return check_block_maps(field);
  }

  Status check_texture(const fb::Field& field) {
    const uint64_t width = field.texture_width(), height = field.texture_height();
    if (width < 1 || width > kMaxTextureSize || height < 1 || height > kMaxTextureSize)
      return malformed("a field's texture has an impossible size");
    // A composed texture with its MIP levels (4/3 of the finest) on both sides of the upload, in half floats, RGBA; and a byte.
    memory_ += (2 * 8 * 4 / 3 + 1) * width * height;
    if (field.coder() == fb::NodeCoder::spiht)
      memory_ += kNodesInDecoding * sizeof(uint16_t) * spiht_scratch_words(static_cast<int>(width), static_cast<int>(height));
    return {};
  }

  static uint32_t values_per_map(const fb::Field& field) { return field.patches() * uint32_t{kTextureMapValues}; }

  Status check_maps(const fb::Field& field) {
    if (field.patches() < 1 || field.patches() > kMaxPatches) return malformed("a field has an impossible number of patches");
    const flatbuffers::Vector<float>& values = *field.maps();
    const uint32_t maps = values.size() / values_per_map(field);
    if (maps < 1 || maps > limits::kMapsPerField || values.size() % values_per_map(field) != 0)
      return malformed("a field has an impossible number of texture maps");
    if (image_.interpolate() && maps != 1) return malformed("a field whose samples are blended has several texture maps");
    // Before any loop over them, as for nodes.
    maps_ += maps * field.patches();
    if (maps_ > limits::kTextureMaps) return malformed("there are too many texture maps");
    for (uint32_t i = 0; i < values.size(); ++i) {
      const bool cut = i % kTextureMapValues < 2;
      if (!in_range(values[i], cut ? 0 : -limits::kTextureMapValue, cut ? 1 : limits::kTextureMapValue))
        return malformed("a texture map is impossible");
    }
    return {};
  }

  // After the nodes, which bound the number of blocks.
  Status check_block_maps(const fb::Field& field) {
    if (!field.block_maps() || field.block_maps()->size() == 0) return {};
    if (field.block_maps()->size() != static_cast<uint32_t>(shape_from_directory(image_, field).block_count()))
      return malformed("a field has not one texture map per block");
    for (const uint16_t map : *field.block_maps())
      if (map >= field.maps()->size() / values_per_map(field))
        return malformed("a block is laid on by a map that does not exist");
    return {};
  }

  Status check_shape(const fb::Field& field) {
    const uint32_t axes = image_.axes()->size(), cells = field.cells()->size();
    if (field.block_size()->size() != axes || field.stagger()->size() != axes)
      return malformed("a field's blocks have not one entry per axis");
    // Without axes a pyramid has no cells; its levels are then counted by the quantizer steps alone.
    const uint32_t levels = field.level_steps()->size() / 3;
    if (levels < 1 || levels > kMaxLevels || field.level_steps()->size() != levels * 3)
      return malformed("a field has an impossible number of quantizer steps");
    if (cells != levels * axes) return malformed("a field's cells have not one entry per level and axis");
    if (field.halved() && field.halved()->size() != 0 && field.halved()->size() != levels)
      return malformed("a field's halved axes have not one entry per level");
    for (const uint16_t step : *field.level_steps())
      if (step < 1) return malformed("a quantizer step is zero");
    if (!shape_from_directory(image_, field).valid()) return malformed("a field's blocks and pyramid contradict each other");
    return {};
  }

  static Status check_contexts(const fb::Field& field) {
    std::array<uint8_t, kMaxLevels * kMostContexts> contexts;
    const size_t levels = field.level_steps()->size() / 3;
    const std::span<const uint8_t> built_in = default_context_bytes(static_cast<NodeCoder>(field.coder()));
    return expand_contexts(context_changes_of(field), built_in, std::span(contexts).first(levels * built_in.size()));
  }

  Status check_nodes(const fb::Field& field) {
    const FieldShape shape = shape_from_directory(image_, field);
    const uint32_t count = static_cast<uint32_t>(shape.node_count());
    if (field.node_bytes()->size() != count || field.node_units()->size() != count)
      return malformed("a field's node tables have not one entry per node");
    // Before any loop over them: overlapping tables cannot make more work than this.
    nodes_ += count;
    if (nodes_ > limits::kCodedNodes) return malformed("there are too many nodes");
    uint64_t bytes = 0;
    for (uint32_t node = 0; node < count; ++node) {
      bytes += field.node_bytes()->Get(node);
      if (Status status = check_coded_node(shape, field, node); !status.ok()) return status;
    }
    if (bytes != image_.sections()->Get(field.nodes())->size()) return malformed("a field's nodes do not fill their section");
    memory_ += uint64_t{32} * count;  // bookkeeping of a scheduler
    return {};
  }

  static Status check_coded_node(const FieldShape& shape, const fb::Field& field, uint32_t node) {
    if (field.node_bytes()->Get(node) == 0) return {};
    if (shape.space.axis_count > 0 && shape.samples_of(static_cast<int>(node)).last[0] < 0)
      return malformed("a node off the grid has bytes");
    if (field.node_units()->Get(node) == 0) return malformed("a coded node costs nothing");
    return {};
  }

  Status check_memory() {
    const uint64_t pixels = uint64_t{image_.width()} * image_.height() * image_.supersampling() * image_.supersampling();
    memory_ += pixels * 12 + image_.plan()->cache_bytes();  // half-float colour and depth
    return memory_ > limits::kEngineBytes ? malformed("the image needs more memory than any may") : Status{};
  }

  const fb::Image& image_;
  SectionCursor sections_;
  uint64_t memory_ = 0, nodes_ = 0, maps_ = 0;
};

}  // namespace

ParameterSpace space_from_directory(const fb::Image& image) {
  ParameterSpace space;
  space.axis_count = static_cast<int>(image.axes()->size());
  for (int a = 0; a < space.axis_count; ++a) {
    const fb::Axis& axis = *image.axes()->Get(static_cast<uint32_t>(a));
    space.axes[a] = {static_cast<AxisKind>(axis.kind()), static_cast<int>(axis.samples())};
  }
  return space;
}

FieldShape shape_from_directory(const fb::Image& image, const fb::Field& field) {
  FieldShape shape;
  shape.space = space_from_directory(image).restricted(field.axes());
  shape.pyramid.level_count = static_cast<int>(field.level_steps()->size() / 3);
  const uint32_t axes = image.axes()->size();
  for (uint32_t a = 0; a < axes; ++a) {
    shape.block_size[a] = field.block_size()->Get(a);
    shape.stagger[a] = field.stagger()->Get(a);
    for (uint32_t level = 0; level < static_cast<uint32_t>(shape.pyramid.level_count); ++level)
      shape.pyramid.cell[level][a] = field.cells()->Get(level * axes + a);
  }
  if (field.halved())
    for (uint32_t level = 0; level < field.halved()->size(); ++level) shape.pyramid.halved[level] = field.halved()->Get(level);
  return shape;
}

Status check_directory(const fb::Image& image) {
  if (Status status = check_picture(image); !status.ok()) return status;
  if (Status status = check_axes(image); !status.ok()) return status;
  if (Status status = check_rig(image); !status.ok()) return status;
  if (Status status = check_camera(image); !status.ok()) return status;
  if (Status status = check_plan(*image.plan()); !status.ok()) return status;
  return ObjectChecker(image).check_all();
}

}  // namespace vitrine
