// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A small image with real coded nodes, and the textures that a player must make of it, computed plainly.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "formats/color.h"
#include "formats/companding.h"
#include "host/encode/node_encoder.h"
#include "target/mip.h"
#include "tests/formats/test_image.h"

namespace vitrine::test {

struct PlayedField {
  FieldShape shape;
  std::vector<std::vector<int16_t>> planes;  // of each node as it decodes; empty: all zero
};

struct PlayedObject {
  int width = 0, height = 0;
  std::vector<PlayedField> fields;
};

struct PlayedImageOptions {
  int width = 40, height = 24, supersampling = 2;  // the first object's texture is the supersampled picture's size
  bool interpolate = false;
  uint64_t units_budget = 1u << 30, cache_bytes = 1u << 30;
  uint32_t horizon_frames = 8;
  float max_speed = 0.25f;
  int view_samples = 16, lamp_samples = 8;
  float exposure = 1;
};

// A camera that looks at "wall", a rectangle that fills the picture exactly, on which lies a layer that depends on the lamp
// and one that depends on view and lamp; and "static", which nothing moves and which stands behind it.
class PlayedImage {
 public:
  explicit PlayedImage(const PlayedImageOptions& options) : options_(options) { build(); }

  std::span<const std::byte> bytes() const { return file_->bytes(); }
  ImageView view() const { return ImageView::open(bytes()).value(); }
  const std::vector<PlayedObject>& objects() const { return objects_; }
  TestImage& source() { return image_; }
  void rewrite() { file_ = std::make_unique<AlignedBytes>(write_image(image_.directory, image_.sections)); }

  // Linear radiance of an object's finest level at a position: R, G, B per texel.
  std::vector<float> texture(size_t object, const Position& position) const {
    const PlayedObject& o = objects_[object];
    std::vector<float> sum(3 * static_cast<size_t>(o.width * o.height));
    for (const PlayedField& field : o.fields) {
      std::array<Corner, kMaxCorners> corners;
      int count = 1;
      corners[0] = {field.shape.space.nearest_sample(position), 1.0f};
      if (options_.interpolate) count = corners_around(field.shape.space, position, corners);
      for (int i = 0; i < count; ++i) add_leaf(o, field, corners[static_cast<size_t>(i)], sum);
    }
    return sum;
  }

 private:
  void build() {
    fb::ImageT& d = image_.directory;
    d.width = static_cast<uint32_t>(options_.width);
    d.height = static_cast<uint32_t>(options_.height);
    d.supersampling = static_cast<uint32_t>(options_.supersampling);
    d.interpolate = options_.interpolate;
    d.exposure = options_.exposure;
    d.axes.push_back(make_axis("view", fb::AxisKind::linear, static_cast<uint32_t>(options_.view_samples)));
    d.axes.push_back(make_axis("lamp", fb::AxisKind::periodic, static_cast<uint32_t>(options_.lamp_samples)));
    for (auto& axis : d.axes) axis->max_speed = options_.max_speed;
    d.nodes.push_back(make_node(-1, 0));
    d.nodes.push_back(make_node(0, 5));  // the camera
    d.camera = std::make_unique<fb::CameraT>();
    d.camera->node = 1;
    d.camera->perspective = false;
    d.camera->yfov = 1;
    d.camera->ymag = 1;
    d.camera->near_distance = 0.1f;
    d.camera->far_distance = 100;
    d.plan = std::make_unique<fb::PlanT>();
    d.plan->units_budget = options_.units_budget;
    d.plan->cache_bytes = options_.cache_bytes;
    d.plan->horizon_frames = options_.horizon_frames;
    const int s = options_.supersampling;
    add_object("wall", s * options_.width, s * options_.height, 0.0f, {2, 3});
    add_object("static", 20, 33, -1.0f, {0});
    rewrite();
  }

  void add_object(const std::string& name, int width, int height, float z, const std::vector<AxisMask>& fields) {
    auto object = std::make_unique<fb::ObjectT>();
    const float half = static_cast<float>(options_.width) / static_cast<float>(options_.height);
    const std::vector<MeshVertex> vertices{{-half, -1, z, 0, 0}, {half, -1, z, 1, 0}, {half, 1, z, 1, 1}, {-half, 1, z, 0, 1}};
    const std::vector<uint32_t> indices{0, 1, 2, 0, 2, 3};
    object->name = name;
    object->node = 0;
    object->vertex_count = 4;
    object->index_count = 6;
    object->culled_index_count = 6;
    object->vertices = image_.add(fb::SectionKind::vertices, coded_vertices(vertices));
    object->indices = image_.add(fb::SectionKind::indices, coded_indices(indices, 4));
    object->texture_width = static_cast<uint32_t>(width);
    object->texture_height = static_cast<uint32_t>(height);
    objects_.push_back({width, height, {}});
    for (const AxisMask axes : fields) object->fields.push_back(add_field(axes, "layer" + std::to_string(axes)));
    image_.directory.objects.push_back(std::move(object));
  }

  // Blocks of four samples and three levels, staggered by one.
  FieldShape shape_of(AxisMask axes) const {
    FieldShape shape;
    shape.space.axis_count = 2;
    shape.space.axes[0] = {AxisKind::kLinear, options_.view_samples};
    shape.space.axes[1] = {AxisKind::kPeriodic, options_.lamp_samples};
    shape.space = shape.space.restricted(axes);
    shape.pyramid.level_count = 3;
    for (size_t a = 0; a < 2; ++a) {
      const bool varies = shape.space.axes[a].samples > 1;
      shape.block_size[a] = varies ? 4 : 1;
      shape.stagger[a] = varies ? 1 : 0;
      for (size_t level = 0; level < 3; ++level) shape.pyramid.cell[level][a] = static_cast<uint8_t>(varies ? 4 >> level : 1);
    }
    return shape;
  }

  std::unique_ptr<fb::FieldT> add_field(AxisMask axes, const std::string& layer) {
    PlayedField truth{shape_of(axes), {}};
    auto field = std::make_unique<fb::FieldT>();
    field->layer = layer;
    field->axes = axes;
    for (size_t a = 0; a < 2; ++a) {
      field->block_size.push_back(truth.shape.block_size[a]);
      field->stagger.push_back(truth.shape.stagger[a]);
    }
    for (size_t level = 0; level < 3; ++level)
      for (size_t a = 0; a < 2; ++a) field->cells.push_back(truth.shape.pyramid.cell[level][a]);
    field->level_steps = {64, 64, 64, 64, 64, 64, 64, 64, 64};
    std::vector<std::byte> coded;
    for (int node = 0; node < truth.shape.node_count(); ++node) {
      const NodeCode code = encode(truth.shape, node, layer);
      for (const uint8_t byte : code.bytes) coded.push_back(static_cast<std::byte>(byte));
      field->node_bytes.push_back(static_cast<uint32_t>(code.bytes.size()));
      field->node_units.push_back(static_cast<uint32_t>(code.units));
      truth.planes.push_back(code.bytes.empty() ? std::vector<int16_t>{} : code.planes);
    }
    field->nodes = image_.add(fb::SectionKind::nodes, std::move(coded));
    field->contexts = image_.add(fb::SectionKind::contexts, {});
    objects_.back().fields.push_back(std::move(truth));
    return field;
  }

  // Some smooth pattern that differs from node to node; coarse levels are bright, finer ones signed.
  NodeCode encode(const FieldShape& shape, int node, const std::string& layer) {
    if (shape.samples_of(node).last[0] < 0 || node % 11 == 5) return {};
    const int level = shape.level_of(node), w = objects_.back().width, h = objects_.back().height;
    std::vector<int16_t> planes(3 * static_cast<size_t>(w * h));
    for (int p = 0; p < 3; ++p)
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
          const double phase = 0.7 * node + 0.11 * x * (p + 1) + 0.17 * y + static_cast<double>(layer.size());
          const double base = level == 0 && p == 0 ? 400 : 0;
          planes[static_cast<size_t>((p * h + y) * w + x)] = static_cast<int16_t>(base + 120 / (level + 1) * std::sin(phase));
        }
    NodeTask task;
    task.width = w;
    task.height = h;
    task.planes = planes;
    task.steps = {64, 64, 64};
    task.weights = {0.01f, 0.01f, 0.01f};
    return encoder_.encode(task);
  }

  void add_leaf(const PlayedObject& o, const PlayedField& field, const Corner& corner, std::vector<float>& sum) const {
    const size_t texels = static_cast<size_t>(o.width * o.height);
    std::vector<int> codes(3 * texels);
    for (int level = 0; level < 3; ++level) {
      const auto& planes = field.planes[static_cast<size_t>(field.shape.node_of(corner.index, level))];
      for (size_t i = 0; i < planes.size(); ++i) codes[i] += planes[i];
    }
    for (size_t i = 0; i < texels; ++i) {
      const RgbCode rgb = rgb_from_ycocg({codes[i], codes[texels + i], codes[2 * texels + i]});
      const int channels[3] = {rgb.r, rgb.g, rgb.b};
      for (size_t c = 0; c < 3; ++c) {
        const auto code = static_cast<size_t>(std::clamp(channels[c], 0, kCodeMax));
        sum[3 * i + c] += corner.weight * float_from_half(half_from_code()[code]);
      }
    }
  }

  PlayedImageOptions options_;
  TestImage image_;
  std::vector<PlayedObject> objects_;
  std::unique_ptr<AlignedBytes> file_;
  NodeEncoder encoder_;
};

}  // namespace vitrine::test
