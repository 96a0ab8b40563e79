// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/bounding_box_reader.h"

#include <algorithm>
#include <cmath>

#include "host/base/error.h"
#include "host/infer/matrix_assembly.h"

namespace vitrine {
namespace {

constexpr int kChannels = 4;
constexpr glm::vec4 kNothing(0);

// The power of two closest to the fourth root of a quarter of the texels (equation 3.3, whose texture is ts x ts): about as many
// renderings find the boxes of blocks of that size as solve them.
int block_size(const Pyramid::Level& level) {
  const double texels = static_cast<double>(level.width) * level.height;
  return 1 << std::max(0, static_cast<int>(std::lround(std::log2(texels / 4) / 4)));
}

size_t object_in(const auto& item) {
  if constexpr (requires { item.blocks; })
    return item.blocks.front().object;
  else
    return item.object;
}

// Parts of `items`, each of which can be rendered at once: first come, first placed.
template <typename Item>
std::vector<std::vector<const Item*>> without_overlaps(const std::vector<Item>& items) {
  std::vector<std::vector<const Item*>> parts;
  for (const Item& item : items) {
    const auto fits = [&](const std::vector<const Item*>& part) {
      return std::none_of(part.begin(), part.end(), [&](const Item* other) {
        return object_in(*other) == object_in(item) && other->box.overlaps(item.box);
      });
    };
    const auto part = std::find_if(parts.begin(), parts.end(), fits);
    if (part == parts.end())
      parts.push_back({&item});
    else
      part->push_back(&item);
  }
  return parts;
}

glm::vec4 unit(int channel) {
  glm::vec4 value(0);
  value[channel] = 1;
  return value;
}

}  // namespace

void BoundingBoxReader::Box::include(int x, int y) {
  left = std::min(left, x);
  right = std::max(right, x);
  bottom = std::min(bottom, y);
  top = std::max(top, y);
}

BoundingBoxReader::BoundingBoxReader(TestRenderer& renderer, std::span<const TextureSize> sizes,
                                     std::span<const TextureWraps> wraps)
    : renderer_(&renderer) {
  for (size_t i = 0; i < sizes.size(); ++i) {
    const Pyramid& pyramid = pyramids_.emplace_back(sizes[i].width, sizes[i].height);
    const TextureWraps own = wraps.empty() ? TextureWraps{} : wraps[i];
    const std::vector<glm::vec4> black(pyramid.size(), kNothing), number(pyramid.size(), glm::vec4(i + 1));
    for (const auto& [list, texels] : {std::pair(&textures_, &black), std::pair(&numbers_, &number)}) {
      list->push_back(create_pyramid_texture(renderer.gpu(), pyramid, hal::TextureFormat::kRgba32f, own));
      update_pyramid_texture(renderer.gpu(), list->back(), pyramid, hal::TextureFormat::kRgba32f,
                             std::as_bytes(std::span(*texels)));
    }
  }
}

BoundingBoxReader::~BoundingBoxReader() {
  for (const auto* list : {&textures_, &numbers_})
    for (const hal::Texture texture : *list) renderer_->gpu().destroy(texture);
}

void BoundingBoxReader::fill(const Block& block, const Texels& texels) {
  std::vector<glm::vec4> values;
  for (int y = 0; y < block.height; ++y)
    for (int x = 0; x < block.width; ++x) values.push_back(texels(x, y));
  const Status status = renderer_->gpu().update_texture(textures_[block.object], static_cast<int>(block.level), block.x, block.y,
                                                        block.width, block.height, std::as_bytes(std::span(values)));
  if (!status.ok()) throw InputError("graphics device", status.detail(), "compile on another (OSMesa)");
}

void BoundingBoxReader::render(const GeometryState& state, int tap) {
  renderer_->render_tap(state, textures_, tap, picture_);
  ++renderings_;
}

template <typename Item>
void BoundingBoxReader::own_boxes(std::span<const Item* const> items) {
  owners_.assign(picture_.size(), -1);
  for (size_t i = 0; i < items.size(); ++i) {
    const Box& box = items[i]->box;
    for (int y = box.bottom; y <= box.top; ++y)
      for (int x = box.left; x <= box.right; ++x) {
        const size_t s = static_cast<size_t>(y) * static_cast<size_t>(renderer_->width()) + static_cast<size_t>(x);
        if (object_of(identifiers_[s]) == static_cast<int>(object_in(*items[i]))) owners_[s] = static_cast<int32_t>(i);
      }
  }
}

// body(sample, x, y, index of its owner, channel) for all that is not black.
template <typename Body>
void BoundingBoxReader::for_each_owned(const Body& body) const {
  const auto width = static_cast<size_t>(renderer_->width());
  for (size_t s = 0; s < picture_.size(); ++s)
    for (int channel = 0; channel < kChannels; ++channel)
      if (owners_[s] >= 0 && picture_[s][channel] > 0)
        body(s, static_cast<int>(s % width), static_cast<int>(s / width), static_cast<size_t>(owners_[s]), channel);
}

// All levels of all objects, in the box of the object.
std::vector<BoundingBoxReader::Family> BoundingBoxReader::whole_levels() const {
  std::vector<Box> boxes(pyramids_.size());
  const auto width = static_cast<size_t>(renderer_->width());
  for (size_t s = 0; s < identifiers_.size(); ++s)
    if (identifiers_[s].w > 0.5f)
      boxes[static_cast<size_t>(object_of(identifiers_[s]))].include(static_cast<int>(s % width), static_cast<int>(s / width));
  std::vector<Family> families;
  for (size_t object = 0; object < pyramids_.size(); ++object) {
    const auto& levels = pyramids_[object].levels();
    for (size_t l = 0; l < levels.size() && !boxes[object].empty(); ++l) {
      if (l % kChannels == 0) families.push_back({boxes[object], {}});
      families.back().blocks.push_back({object, l, 0, 0, levels[l].width, levels[l].height, {}});
    }
  }
  return families;
}

// The blocks that some supersample sees, with their boxes.
std::vector<BoundingBoxReader::Block> BoundingBoxReader::measure(const GeometryState& state, int tap,
                                                                 std::vector<Family> families) {
  std::vector<Block> visible;
  for (const auto& part : without_overlaps(families)) {
    for (const Family* family : part)
      for (size_t i = 0; i < family->blocks.size(); ++i)
        fill(family->blocks[i], [&](int, int) { return unit(static_cast<int>(i)); });
    render(state, tap);
    own_boxes<Family>(part);
    for (const Family* family : part)
      for (const Block& block : family->blocks) fill(block, [](int, int) { return kNothing; });
    std::vector<Box> boxes(part.size() * kChannels);
    for_each_owned([&](size_t, int x, int y, size_t owner, int channel) {
      boxes[owner * kChannels + static_cast<size_t>(channel)].include(x, y);
    });
    for (size_t f = 0; f < part.size(); ++f)
      for (size_t i = 0; i < part[f]->blocks.size(); ++i) {
        Block block = part[f]->blocks[i];
        block.box = boxes[f * kChannels + i];
        if (!block.box.empty()) visible.push_back(block);
      }
  }
  return visible;
}

std::vector<BoundingBoxReader::Block> BoundingBoxReader::visible_blocks(const GeometryState& state, int tap) {
  std::vector<Block> found, current = measure(state, tap, whole_levels());
  while (!current.empty()) {
    std::vector<Family> quarters;
    for (const Block& block : current) {
      const int size = block_size(pyramids_[block.object].levels()[block.level]);
      if (std::max(block.width, block.height) <= size) {
        found.push_back(block);
        continue;
      }
      quarters.push_back({block.box, {}});
      const int half_width = block.width > size ? (block.width + 1) / 2 : block.width;
      const int half_height = block.height > size ? (block.height + 1) / 2 : block.height;
      for (int y = 0; y < block.height; y += half_height)
        for (int x = 0; x < block.width; x += half_width)
          quarters.back().blocks.push_back({block.object,
                                            block.level,
                                            block.x + x,
                                            block.y + y,
                                            std::min(half_width, block.width - x),
                                            std::min(half_height, block.height - y),
                                            {}});
    }
    current = measure(state, tap, std::move(quarters));
  }
  return found;
}

void BoundingBoxReader::solve(const GeometryState& state, int tap, std::span<const Block* const> blocks, TapRows& rows) {
  own_boxes<Block>(blocks);
  int largest = 0;
  for (const Block* block : blocks) largest = std::max(largest, block->width * block->height);
  for (int first = 0; first < largest; first += kChannels) {
    for (const Block* block : blocks)
      fill(*block, [&](int x, int y) {
        const int place = y * block->width + x - first;
        return place >= 0 && place < kChannels ? unit(place) : kNothing;
      });
    render(state, tap);
    for_each_owned([&](size_t sample, int, int, size_t owner, int channel) {
      const Block& block = *blocks[owner];
      const Pyramid::Level& level = pyramids_[block.object].levels()[block.level];
      const int place = first + channel, x = block.x + place % block.width, y = block.y + place / block.width;
      if (picture_[sample][channel] > kSmallestWeight)
        rows.add(sample, static_cast<uint32_t>(level.offset) + static_cast<uint32_t>(y * level.width + x),
                 picture_[sample][channel]);
    });
  }
  for (const Block* block : blocks) fill(*block, [](int, int) { return kNothing; });
}

void BoundingBoxReader::read_tap(const GeometryState& state, int tap, TapRows& rows) {
  rows.reset(picture_.size());
  const std::vector<Block> blocks = visible_blocks(state, tap);
  for (const auto& part : without_overlaps(blocks)) solve(state, tap, part, rows);
}

StateMatrix BoundingBoxReader::read_state(const GeometryState& state) {
  picture_.resize(static_cast<size_t>(renderer_->width()) * static_cast<size_t>(renderer_->height()));
  identifiers_.resize(picture_.size());
  renderer_->render(state, numbers_, identifiers_);
  ++renderings_;
  std::vector<TapRows> rows(static_cast<size_t>(renderer_->taps()));
  std::vector<const TapRows*> all;
  for (size_t t = 0; t < rows.size(); ++t) {
    read_tap(state, static_cast<int>(t), rows[t]);
    all.push_back(&rows[t]);
  }
  return assemble_taps(*renderer_, identifiers_, pyramids_.size(), all);
}

std::vector<StateMatrix> BoundingBoxReader::read(std::span<const GeometryState* const> states) {
  std::vector<StateMatrix> matrices;
  for (const GeometryState* state : states) matrices.push_back(read_state(*state));
  return matrices;
}

}  // namespace vitrine
