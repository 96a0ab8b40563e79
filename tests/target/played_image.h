// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A small image with real coded nodes, and the textures that a player must make of it, computed plainly.
#pragma once

#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/color.h"
#include "formats/companding.h"
#include "formats/node_coder.h"
#include "host/encode/node_encoder.h"
#include "host/encode/spiht_encoder.h"
#include "target/mip.h"
#include "tests/formats/test_image.h"

namespace vitrine::test {

// Where the supersampled picture lies in a texture that is at least as large: the halves exchanged or not, then moved.
struct Placement {
  bool cut = false;
  int left = 0, bottom = 0;  // texels
};

struct PlayedField {
  FieldShape shape;
  int width = 0, height = 0;
  std::vector<Placement> placements;         // of block b: number b modulo their count
  std::vector<std::vector<int16_t>> planes;  // of each node as it decodes; empty: all zero

  const Placement& placement_of(const GridIndex& sample) const {
    return placements[static_cast<size_t>(shape.block_of(sample)) % placements.size()];
  }
};

struct PlayedImageOptions {
  int width = 40, height = 24, supersampling = 2;  // the first field's texture is the supersampled picture's size
  bool interpolate = false;
  uint64_t units_budget = 1u << 30, cache_bytes = 1u << 30;
  uint32_t horizon_frames = 8;
  float max_speed = 0.25f;
  int view_samples = 16, lamp_samples = 8;
  float exposure = 1;
  SurfaceFilter filter = SurfaceFilter::kTrilinear;
  NodeCoder coder = NodeCoder::kDct;
};

// A camera that looks at "wall", a rectangle that fills the picture exactly, texel on pixel, on which lies a layer that depends
// on the lamp and one that depends on view and lamp and whose larger textures lie otherwise from block to block (with
// `interpolate`: all alike, and cut); and "static", which nothing moves and which stands behind it.
class PlayedImage {
 public:
  explicit PlayedImage(const PlayedImageOptions& options) : options_(options) { build(); }

  std::span<const std::byte> bytes() const { return file_->bytes(); }
  ImageView view() const { return ImageView::open(bytes()).value(); }
  const std::vector<PlayedField>& fields() const { return fields_; }  // the wall's two, then the other
  TestImage& source() { return image_; }
  void rewrite() { file_ = std::make_unique<AlignedBytes>(write_image(image_.directory, image_.sections)); }

  // Linear radiance of a field's finest level at a position: R, G, B per texel.
  std::vector<float> texture(const PlayedField& field, const Position& position) const {
    std::vector<float> sum(3 * static_cast<size_t>(field.width * field.height));
    std::array<Corner, kMaxCorners> corners;
    int count = 1;
    corners[0] = {field.shape.space.nearest_sample(position), 1.0f};
    if (options_.interpolate) count = corners_around(field.shape.space, position, corners);
    for (int i = 0; i < count; ++i) add_leaf(field, corners[static_cast<size_t>(i)], sum);
    return sum;
  }

  // Linear radiance of the supersampled picture: R, G, B per pixel, bottom row first.
  std::vector<float> picture(const Position& position) const {
    const int columns = options_.supersampling * options_.width, rows = options_.supersampling * options_.height;
    std::vector<float> sum(3 * static_cast<size_t>(columns * rows));
    for (const PlayedField& field : std::span(fields_).first(2)) {
      const std::vector<float> texels = texture(field, position);
      const Placement& placement = field.placement_of(field.shape.space.nearest_sample(position));
      for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
          const int u = (placement.cut ? (x + columns / 2) % columns : x) + placement.left, v = y + placement.bottom;
          for (int c = 0; c < 3; ++c)
            sum[static_cast<size_t>(3 * (y * columns + x) + c)] += texels[static_cast<size_t>(3 * (v * field.width + u) + c)];
        }
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
    d.filter = static_cast<fb::SurfaceFilter>(options_.filter);
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
    const int w = options_.supersampling * options_.width, h = options_.supersampling * options_.height;
    fb::ObjectT& wall = add_object("wall", 0);
    add_field(wall, 2, w, h, {{}});
    const std::vector<Placement> placements{{true, 2, 1}, {false, 5, 3}, {true, 0, 4}};
    add_field(wall, 3, w + 6, h + 4, options_.interpolate ? std::vector{placements[0]} : placements);
    add_field(add_object("static", -1), 0, 20, 33, {{}});
    rewrite();
  }

  // Its left half and its right half share no vertex: the mesh's coordinates can be cut between them.
  fb::ObjectT& add_object(const std::string& name, float z) {
    auto object = std::make_unique<fb::ObjectT>();
    const float side = static_cast<float>(options_.width) / static_cast<float>(options_.height);
    const float seam = 0.5f - 1 / kTextureSteps;
    const std::vector<MeshVertex> vertices{{-side, -1, z, 0, 0}, {0, -1, z, seam, 0}, {0, 1, z, seam, 1}, {-side, 1, z, 0, 1},
                                           {0, -1, z, 0.5f, 0},  {side, -1, z, 1, 0}, {side, 1, z, 1, 1}, {0, 1, z, 0.5f, 1}};
    const std::vector<uint32_t> indices{0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
    object->name = name;
    object->node = 0;
    object->culled_index_count = static_cast<uint32_t>(indices.size());
    add_mesh(image_, *object, vertices, indices);
    image_.directory.objects.push_back(std::move(object));
    return *image_.directory.objects.back();
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

  // The map that lays a texture on the mesh as `placement` says.
  TextureMap map_of(const Placement& placement, int width, int height) const {
    const auto w = static_cast<float>(options_.supersampling * options_.width),
               h = static_cast<float>(options_.supersampling * options_.height);
    const glm::vec2 size(width, height), corner(placement.left, placement.bottom), cut(placement.cut ? 0.5f : 0.0f, 0);
    return PatchMap{cut, glm::mat2(w / size.x, 0, 0, h / size.y), (corner - cut * glm::vec2(w, h)) / size};
  }

  void add_field(fb::ObjectT& object, AxisMask axes, int width, int height, const std::vector<Placement>& placements) {
    PlayedField truth{shape_of(axes), width, height, placements, {}};
    auto field = std::make_unique<fb::FieldT>();
    field->layer = "layer" + std::to_string(axes);
    field->axes = axes;
    field->coder = static_cast<fb::NodeCoder>(options_.coder);
    field->texture_width = static_cast<uint32_t>(width);
    field->texture_height = static_cast<uint32_t>(height);
    for (const Placement& placement : placements) add_map(*field, map_of(placement, width, height));
    for (int block = 0; placements.size() > 1 && block < truth.shape.block_count(); ++block)
      field->block_maps.push_back(static_cast<uint16_t>(static_cast<size_t>(block) % placements.size()));
    for (size_t a = 0; a < 2; ++a) {
      field->block_size.push_back(truth.shape.block_size[a]);
      field->stagger.push_back(truth.shape.stagger[a]);
    }
    for (size_t level = 0; level < 3; ++level)
      for (size_t a = 0; a < 2; ++a) field->cells.push_back(truth.shape.pyramid.cell[level][a]);
    field->level_steps = {64, 64, 64, 64, 64, 64, 64, 64, 64};
    std::vector<std::byte> coded;
    for (int node = 0; node < truth.shape.node_count(); ++node) {
      const NodeCode code = encode(truth, node);
      for (const uint8_t byte : code.bytes) coded.push_back(static_cast<std::byte>(byte));
      field->node_bytes.push_back(static_cast<uint32_t>(code.bytes.size()));
      field->node_units.push_back(static_cast<uint32_t>(code.units));
      truth.planes.push_back(code.bytes.empty() ? std::vector<int16_t>{} : code.planes);
    }
    field->nodes = image_.add(fb::SectionKind::nodes, std::move(coded));
    fields_.push_back(std::move(truth));
    object.fields.push_back(std::move(field));
  }

  // Some smooth pattern that differs from node to node; coarse levels are bright, finer ones signed.
  NodeCode encode(const PlayedField& field, int node) {
    if (field.shape.samples_of(node).last[0] < 0 || node % 11 == 5) return {};
    const int level = field.shape.level_of(node), w = field.width, h = field.height;
    std::vector<int16_t> planes(3 * static_cast<size_t>(w * h));
    for (int p = 0; p < 3; ++p)
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
          const double phase = 0.7 * node + 0.11 * x * (p + 1) + 0.17 * y;
          const double base = level == 0 && p == 0 ? 400 : 0;
          planes[static_cast<size_t>((p * h + y) * w + x)] = static_cast<int16_t>(base + 120 / (level + 1) * std::sin(phase));
        }
    NodeTask task;
    task.width = w;
    task.height = h;
    task.planes = planes;
    task.steps = {64, 64, 64};
    task.weights = {0.01f, 0.01f, 0.01f};
    return options_.coder == NodeCoder::kSpiht ? spiht_.encode(task) : dct_.encode(task);
  }

  void add_leaf(const PlayedField& field, const Corner& corner, std::vector<float>& sum) const {
    const size_t texels = static_cast<size_t>(field.width * field.height);
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
  std::vector<PlayedField> fields_;
  std::unique_ptr<AlignedBytes> file_;
  NodeEncoder dct_;
  SpihtEncoder spiht_;
};

}  // namespace vitrine::test
