// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A small valid image as an editable directory and sections: tests change one thing and look what a reader says.
#pragma once

#include <meshoptimizer.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "formats/image.h"
#include "formats/mesh.h"
#include "formats/node_coding.h"
#include "host/link/image_writer.h"

namespace vitrine::test {

inline std::vector<MeshVertex> test_vertices() {
  return {{-1, -1, 0, 0, 0}, {1, -1, 0, 1, 0}, {1, 1, 0, 1, 1}, {-1, 1, 0, 0, 1}, {0, 0, 1, 0.2f, 0.6f}};
}
inline std::vector<uint32_t> test_indices() { return {0, 1, 2, 0, 2, 3, 0, 1, 4}; }

// Steps of a power of two from the corner at (-64, -64, -64): whole numbers up to 64 lie on it exactly.
inline MeshGrid test_grid() { return {glm::vec3(-64), 0x1p-9f}; }
inline GridVertex on_test_grid(const MeshVertex& v) {
  const auto step = [](float position) { return static_cast<uint16_t>((position + 64) * 512); };
  return {step(v.x),
          step(v.y),
          step(v.z),
          0,
          static_cast<uint16_t>(v.u * kTextureSteps + 0.5f),
          static_cast<uint16_t>(v.v * kTextureSteps + 0.5f)};
}

inline std::vector<std::byte> coded_vertices(const std::vector<MeshVertex>& vertices) {
  std::vector<GridVertex> steps;
  for (const MeshVertex& vertex : vertices) steps.push_back(on_test_grid(vertex));
  meshopt_encodeVertexVersion(0);
  std::vector<std::byte> coded(meshopt_encodeVertexBufferBound(steps.size(), sizeof(GridVertex)));
  coded.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(coded.data()), coded.size(), steps.data(),
                                          steps.size(), sizeof(GridVertex)));
  return coded;
}
inline std::vector<std::byte> coded_indices(const std::vector<uint32_t>& indices, size_t vertex_count) {
  meshopt_encodeIndexVersion(1);
  std::vector<std::byte> coded(meshopt_encodeIndexBufferBound(indices.size(), vertex_count));
  coded.resize(
      meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(coded.data()), coded.size(), indices.data(), indices.size()));
  return coded;
}

struct TestImage {
  fb::ImageT directory;
  std::vector<ImageSection> sections;

  AlignedBytes file() { return AlignedBytes(write_image(directory, sections)); }
  uint32_t add(fb::SectionKind kind, std::vector<std::byte> bytes) {
    sections.push_back({kind, std::move(bytes)});
    return static_cast<uint32_t>(sections.size() - 1);
  }
};

// Puts a mesh into a section of its own.
inline void add_mesh(TestImage& image, fb::ObjectT& object, const std::vector<MeshVertex>& vertices,
                     const std::vector<uint32_t>& indices) {
  std::vector<std::byte> coded = coded_vertices(vertices), coded_end = coded_indices(indices, vertices.size());
  object.vertex_count = static_cast<uint32_t>(vertices.size());
  object.index_count = static_cast<uint32_t>(indices.size());
  object.coded_vertex_bytes = static_cast<uint32_t>(coded.size());
  object.coded_index_bytes = static_cast<uint32_t>(coded_end.size());
  object.grid_origin = std::make_unique<fb::Vec3>(test_grid().origin.x, test_grid().origin.y, test_grid().origin.z);
  object.grid_step = test_grid().step;
  coded.insert(coded.end(), coded_end.begin(), coded_end.end());
  object.mesh = image.add(fb::SectionKind::mesh, compress(coded));
}

inline std::unique_ptr<fb::AxisT> make_axis(const std::string& name, fb::AxisKind kind, uint32_t samples) {
  auto axis = std::make_unique<fb::AxisT>();
  axis->name = name;
  axis->kind = kind;
  axis->samples = samples;
  axis->max_speed = 0.25f;
  return axis;
}

inline std::unique_ptr<fb::RigNodeT> make_node(int32_t parent, float z) {
  auto node = std::make_unique<fb::RigNodeT>();
  node->parent = parent;
  node->translation = std::make_unique<fb::Vec3>(0.0f, 0.0f, z);
  node->rotation = std::make_unique<fb::Quat>(0.0f, 0.0f, 0.0f, 1.0f);
  node->scale = std::make_unique<fb::Vec3>(1.0f, 1.0f, 1.0f);
  return node;
}

inline void add_map(fb::FieldT& field, const TextureMap& map) {
  field.patches = static_cast<uint8_t>(map.patch_count);
  for (size_t patch = 0; patch < field.patches; ++patch) {
    const auto values = map.patches[patch].values();
    field.maps.insert(field.maps.end(), values.begin(), values.end());
  }
}

// A field of blocks of 4 samples with three levels, which lie on the mesh by two maps in turn; every third node on the grid has
// bytes (not a coder's: nothing here decodes them).
inline std::unique_ptr<fb::FieldT> make_field(TestImage& image, const std::string& layer, AxisMask axes) {
  auto field = std::make_unique<fb::FieldT>();
  field->layer = layer;
  field->axes = axes;
  field->texture_width = 40;
  field->texture_height = 24;
  add_map(*field, {});
  add_map(*field, PatchMap{{0.25f, 0}, glm::mat2(0.5f, 0.125f, -0.25f, 2), {0.75f, -1}});
  FieldShape shape;
  shape.space.axis_count = static_cast<int>(image.directory.axes.size());
  for (int a = 0; a < shape.space.axis_count; ++a)
    shape.space.axes[a] = {static_cast<AxisKind>(image.directory.axes[static_cast<size_t>(a)]->kind),
                           static_cast<int>(image.directory.axes[static_cast<size_t>(a)]->samples)};
  shape.space = shape.space.restricted(axes);
  shape.pyramid.level_count = 3;
  for (int a = 0; a < shape.space.axis_count; ++a) {
    const bool varies = shape.space.axes[a].samples > 1;
    shape.block_size[a] = varies ? 4 : 1;
    shape.stagger[a] = varies ? 1 : 0;
    field->block_size.push_back(shape.block_size[a]);
    field->stagger.push_back(shape.stagger[a]);
  }
  for (int level = 0; level < 3; ++level)
    for (int a = 0; a < shape.space.axis_count; ++a) {
      shape.pyramid.cell[level][a] = static_cast<uint8_t>(shape.block_size[a] >> (shape.block_size[a] > 1 ? level : 0));
      field->cells.push_back(shape.pyramid.cell[level][a]);
    }
  for (int block = 0; block < shape.block_count(); ++block) field->block_maps.push_back(static_cast<uint16_t>(block % 2));
  field->level_steps = {64, 80, 80, 32, 40, 40, 16, 20, 20};
  std::vector<std::byte> nodes;
  for (int node = 0; node < shape.node_count(); ++node) {
    const bool coded = node % 3 == 0 && shape.samples_of(node).last[0] >= 0;
    const uint32_t bytes = coded ? 5 + static_cast<uint32_t>(node) % 7 : 0;
    for (uint32_t i = 0; i < bytes; ++i) nodes.push_back(static_cast<std::byte>(node * 31 + static_cast<int>(i)));
    field->node_bytes.push_back(bytes);
    field->node_units.push_back(128 + 8 * bytes);
  }
  field->nodes = image.add(fb::SectionKind::nodes, std::move(nodes));
  field->contexts = {2, 0, 0x41, 7, 0x82, 0, 1, 159, 0x10};  // three levels: two changes, none, one
  return field;
}

inline std::unique_ptr<fb::ObjectT> make_object(TestImage& image, const std::string& name, uint32_t node) {
  auto object = std::make_unique<fb::ObjectT>();
  object->name = name;
  object->node = node;
  const auto vertices = test_vertices();
  const auto indices = test_indices();
  object->culled_index_count = 6;
  add_mesh(image, *object, vertices, indices);
  return object;
}

// Axes view (linear, 10) and lamp (periodic, 4); a rig of four nodes with a rotation and a spline track; two objects, one of
// them with two fields.
inline TestImage make_test_image() {
  TestImage image;
  fb::ImageT& d = image.directory;
  d.producer = "test";
  d.width = 64;
  d.height = 48;
  d.supersampling = 2;
  d.filter = fb::SurfaceFilter::anisotropic2;
  d.axes.push_back(make_axis("view", fb::AxisKind::linear, 10));
  d.axes.push_back(make_axis("lamp", fb::AxisKind::periodic, 4));
  for (int n = 0; n < 4; ++n) d.nodes.push_back(make_node(n - 1, static_cast<float>(n)));
  d.nodes[3]->matrix.assign(16, 0.0f);
  for (size_t i = 0; i < 16; i += 5) d.nodes[3]->matrix[i] = 1;
  auto turn = std::make_unique<fb::RigTrackT>();
  turn->node = 1;
  turn->axis = 0;
  turn->path = fb::TrackPath::rotation;
  turn->interpolation = fb::Interpolation::linear;
  turn->positions = {0, 0.5f, 1};
  turn->values = {0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, -1};
  d.tracks.push_back(std::move(turn));
  auto slide = std::make_unique<fb::RigTrackT>();
  slide->node = 2;
  slide->axis = 1;
  slide->path = fb::TrackPath::translation;
  slide->interpolation = fb::Interpolation::cubic_spline;
  slide->positions = {0, 1};
  slide->values.assign(18, 0.5f);
  d.tracks.push_back(std::move(slide));
  d.camera = std::make_unique<fb::CameraT>();
  d.camera->node = 2;
  d.camera->yfov = 0.7f;
  d.camera->ymag = 1;
  d.camera->near_distance = 0.1f;
  d.camera->far_distance = 100;
  d.plan = std::make_unique<fb::PlanT>();
  d.plan->units_budget = 1000000;
  d.plan->units_worst = 900000;
  d.plan->upload_worst = 1 << 20;
  d.plan->cache_bytes = 1 << 22;
  d.plan->settle_frames = 3;
  d.plan->horizon_frames = 4;
  d.objects.push_back(make_object(image, "vase", 3));
  d.objects[0]->fields.push_back(make_field(image, "diffuse", 2));
  d.objects[0]->fields.push_back(make_field(image, "specular", 3));
  d.objects.push_back(make_object(image, "floor", 0));
  d.objects[1]->fields.push_back(make_field(image, "diffuse", 0));
  return image;
}

}  // namespace vitrine::test
