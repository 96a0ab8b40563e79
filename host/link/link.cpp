// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/link/link.h"

#include <memory>
#include <stdexcept>
#include <string>

#include "formats/context_changes.h"
#include "formats/text.h"
#include "host/base/error.h"
#include "host/link/image_writer.h"
#include "host/link/mesh_encoder.h"
#include "host/link/rig_subset.h"

namespace vitrine {
namespace {

std::unique_ptr<fb::Vec3> to_vec3(const glm::vec3& v) { return std::make_unique<fb::Vec3>(v.x, v.y, v.z); }

// Names are the scene's own words: what an image cannot hold is the user's to change.
const std::string& checked_name(const Scene& scene, const char* what, const std::string& name) {
  if (!is_plain_text(name) || name.size() > limits::kNameBytes)
    throw InputError(scene.file.string(), std::string(what) + " has an empty, too long or unprintable name",
                     "give it a name of at most 255 bytes of printable UTF-8");
  return name;
}

void check_limits(const Scene& scene, const Inference& inference) {
  if (inference.objects.size() > kMaxObjects)
    throw InputError(scene.file.string(),
                     std::to_string(inference.objects.size()) + " objects are seen, an image holds at most 4096",
                     "join meshes that move together");
  for (const Axis& axis : scene.axes)
    if (axis.shape.samples > static_cast<int>(limits::kAxisSamples))
      throw InputError(scene.file.string() + ": axis " + axis.name, "more than 4096 samples", "give it fewer samples");
  if (static_cast<uint64_t>(scene.space().sample_count()) > limits::kGridSamples)
    throw InputError(scene.file.string(), "the grid has more than 2^24 samples", "give the axes fewer samples");
}

// Collects the directory and the sections side by side; objects and fields name sections in the order in which they are added.
class Linker {
 public:
  explicit Linker(const LinkInput& input) : input_(input), scene_(*input.scene), inference_(*input.inference) {}

  std::vector<std::byte> link() {
    check_limits(scene_, inference_);
    add_picture();
    add_axes();
    add_rig();
    for (int i = 0; i < static_cast<int>(inference_.objects.size()); ++i) add_object(i);
    add_plan();
    return write_image(image_, sections_);
  }

 private:
  void add_picture() {
    image_.producer = "vitrine " VITRINE_VERSION;
    image_.width = static_cast<uint32_t>(input_.width);
    image_.height = static_cast<uint32_t>(input_.height);
    image_.supersampling = static_cast<uint32_t>(input_.supersampling);
    image_.filter = static_cast<fb::SurfaceFilter>(input_.filter);
    image_.paths_per_pixel = static_cast<uint32_t>(input_.scene->settings.samples_per_pixel);
    image_.noise_db = input_.scene->settings.noise_db;
    image_.frames_key = input_.frames_key;
    image_.exposure = scene_.settings.exposure;
    image_.interpolate = scene_.settings.interpolate;
  }

  void add_axes() {
    for (const Axis& axis : scene_.axes) {
      auto out = std::make_unique<fb::AxisT>();
      out->name = checked_name(scene_, "an axis", axis.name);
      out->kind = static_cast<fb::AxisKind>(axis.shape.kind);
      out->samples = static_cast<uint32_t>(axis.shape.samples);
      out->max_speed = axis.max_speed;
      image_.axes.push_back(std::move(out));
    }
  }

  void add_rig() {
    std::vector<int> carriers{scene_.camera.node};
    for (const DrawnObject& drawn : inference_.objects) carriers.push_back(scene_object(drawn).node);
    rig_ = select_rig(scene_, carriers);
    for (const uint32_t node : rig_.nodes) add_node(scene_.nodes[node]);
    for (const uint32_t track : rig_.tracks) add_track(scene_.tracks[track]);
    add_camera();
  }

  void add_node(const RigNode& node) {
    auto out = std::make_unique<fb::RigNodeT>();
    out->parent = node.parent < 0 ? -1 : new_number(node.parent);
    out->translation = to_vec3(node.translation);
    out->rotation = std::make_unique<fb::Quat>(node.rotation.x, node.rotation.y, node.rotation.z, node.rotation.w);
    out->scale = to_vec3(node.scale);
    if (node.matrix != glm::mat4(1))
      for (int i = 0; i < 16; ++i) out->matrix.push_back(node.matrix[i / 4][i % 4]);
    image_.nodes.push_back(std::move(out));
  }

  void add_track(const RigTrack& track) {
    auto out = std::make_unique<fb::RigTrackT>();
    out->node = static_cast<uint32_t>(new_number(static_cast<int>(track.node)));
    out->axis = track.axis;
    out->path = static_cast<fb::TrackPath>(track.path);
    out->interpolation = static_cast<fb::Interpolation>(track.interpolation);
    out->positions.assign(track.positions.begin(), track.positions.end());
    out->values.assign(track.values.begin(), track.values.end());
    image_.tracks.push_back(std::move(out));
  }

  void add_camera() {
    const Camera& camera = scene_.camera;
    image_.camera = std::make_unique<fb::CameraT>();
    image_.camera->node = static_cast<uint32_t>(new_number(camera.node));
    image_.camera->perspective = camera.perspective;
    image_.camera->yfov = camera.yfov;
    image_.camera->ymag = camera.ymag;
    image_.camera->near_distance = camera.near_distance;
    image_.camera->far_distance = camera.far_distance;
  }

  void add_object(int number) {
    const DrawnObject& drawn = inference_.objects[static_cast<size_t>(number)];
    const Object& object = scene_object(drawn);
    auto out = std::make_unique<fb::ObjectT>();
    out->name = checked_name(scene_, "an object", object.name);
    out->representation = fb::Representation::texture;
    out->node = static_cast<uint32_t>(new_number(object.node));
    out->follows_camera = object.follows_camera;
    add_mesh(drawn, *out);
    for (size_t field = 0; field < inference_.fields.size(); ++field)
      if (inference_.fields[field].drawn_object == number)
        out->fields.push_back(make_field(inference_.fields[field], (*input_.encoded)[field]));
    image_.objects.push_back(std::move(out));
  }

  void add_mesh(const DrawnObject& drawn, fb::ObjectT& out) {
    MeshSection mesh = mesh_section(drawn);
    out.vertex_count = mesh.vertex_count;
    out.index_count = static_cast<uint32_t>(drawn.indices.size());
    out.culled_index_count = drawn.culled_index_count;
    out.coded_vertex_bytes = mesh.coded_vertex_bytes;
    out.coded_index_bytes = mesh.coded_index_bytes;
    out.grid_origin = to_vec3(drawn.grid.origin);
    out.grid_step = drawn.grid.step;
    out.mesh = add_section(fb::SectionKind::mesh, std::move(mesh.bytes));
  }

  std::unique_ptr<fb::FieldT> make_field(const Field& field, const EncodedField& encoded) {
    auto out = std::make_unique<fb::FieldT>();
    out->layer = checked_name(scene_, "a layer", field.layer);
    out->axes = field.axes;
    add_texture(field, *out);
    add_shape(encoded.shape, *out);
    out->coder = static_cast<fb::NodeCoder>(encoded.coder);
    out->level_steps = encoded.level_steps;
    out->nodes = add_section(fb::SectionKind::nodes, as_bytes(encoded.nodes));
    out->contexts = context_changes(encoded.contexts, default_context_bytes(encoded.coder));
    out->node_bytes = encoded.node_bytes;
    out->node_units = encoded.node_units;
    return out;
  }

  static void add_texture(const Field& field, fb::FieldT& out) {
    out.texture_width = static_cast<uint32_t>(field.texture_width);
    out.texture_height = static_cast<uint32_t>(field.texture_height);
    out.patches = static_cast<uint8_t>(field.maps.front().patch_count);
    for (const TextureMap& map : field.maps)
      for (size_t patch = 0; patch < out.patches; ++patch)
        for (const float value : map.patches[patch].values()) out.maps.push_back(value);
    out.block_maps = field.block_maps;
  }

  static void add_shape(const FieldShape& shape, fb::FieldT& out) {
    for (int a = 0; a < shape.space.axis_count; ++a) {
      out.block_size.push_back(shape.block_size[a]);
      out.stagger.push_back(shape.stagger[a]);
    }
    for (int level = 0; level < shape.pyramid.level_count; ++level) out.halved.push_back(shape.pyramid.halved[level]);
    for (int level = 0; level < shape.pyramid.level_count; ++level)
      for (int a = 0; a < shape.space.axis_count; ++a) out.cells.push_back(shape.pyramid.cell[level][a]);
  }

  void add_plan() {
    image_.plan = std::make_unique<fb::PlanT>();
    image_.plan->units_budget = input_.plan.units_budget;
    image_.plan->units_worst = input_.plan.units_worst;
    image_.plan->upload_worst = input_.plan.upload_worst;
    image_.plan->cache_bytes = input_.plan.cache_bytes;
    image_.plan->settle_frames = input_.plan.settle_frames;
    image_.plan->horizon_frames = input_.plan.horizon_frames;
  }

  uint32_t add_section(fb::SectionKind kind, std::vector<std::byte> bytes) {
    sections_.push_back({kind, std::move(bytes)});
    return static_cast<uint32_t>(sections_.size() - 1);
  }

  static std::vector<std::byte> as_bytes(const std::vector<uint8_t>& data) {
    const auto* bytes = reinterpret_cast<const std::byte*>(data.data());
    return {bytes, bytes + data.size()};
  }

  const Object& scene_object(const DrawnObject& drawn) const { return scene_.objects[static_cast<size_t>(drawn.object)]; }
  int32_t new_number(int scene_node) const { return rig_.new_number[static_cast<size_t>(scene_node)]; }

  const LinkInput& input_;
  const Scene& scene_;
  const Inference& inference_;
  RigSubset rig_;
  fb::ImageT image_;
  std::vector<ImageSection> sections_;
};

}  // namespace

MeshSection mesh_section(const DrawnObject& object) {
  EncodedMesh mesh = encode_mesh(object.vertices, object.grid, object.indices, object.culled_index_count);
  MeshSection section;
  section.vertex_count = mesh.vertex_count;
  section.coded_vertex_bytes = static_cast<uint32_t>(mesh.vertices.size());
  section.coded_index_bytes = static_cast<uint32_t>(mesh.indices.size());
  mesh.vertices.insert(mesh.vertices.end(), mesh.indices.begin(), mesh.indices.end());
  section.bytes = compress(mesh.vertices);
  return section;
}

std::vector<std::byte> link_image(const LinkInput& input) {
  std::vector<std::byte> file = Linker(input).link();
  const AlignedBytes copy{file};
  const Result<ImageView> opened = ImageView::open(copy.bytes());
  if (!opened.ok()) throw std::logic_error(std::string("the linked image cannot be opened: ") + opened.status().detail());
  return file;
}

}  // namespace vitrine
