// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/texture_layout.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <map>
#include <numeric>
#include <set>

#include "host/base/error.h"
#include "host/infer/domain_patches.h"
#include "host/infer/rectangle_packing.h"

namespace vitrine {
namespace {

constexpr int kSizeStep = 8;
constexpr float kShrink = 0.98f;
constexpr float kMostGrowth = 64;
constexpr int kGrowthSteps = 20;
// A single map is finer than the bound over most of what it shows. Patches, each fitted by itself, have no such reserve.
constexpr float kPatchReserve = 1.1f;
constexpr size_t kRegionsOfField = 3;  // by which patches are chosen
constexpr size_t kMostMaps = 65535;    // formats/SPEC.md

// Samples that a texture of sample `at` along an axis may be shown beside: its neighbours, where there is anything between.
std::vector<int> beside(const AxisShape& axis, int at) {
  if (axis.kind == AxisKind::kDiscrete) return {at};
  std::vector<int> samples;
  for (const int k : {at - 1, at, at + 1}) {
    if (axis.kind == AxisKind::kPeriodic)
      samples.push_back((k + axis.samples) % axis.samples);
    else if (k >= 0 && k < axis.samples)
      samples.push_back(k);
  }
  return samples;
}

// Calls body(neighbour) for the sample and all around it.
template <typename Body>
void for_each_beside(const ParameterSpace& space, const GridIndex& sample, int axis, GridIndex& neighbour, const Body& body) {
  if (axis == space.axis_count) return body(neighbour);
  for (const int k : beside(space.axes[static_cast<size_t>(axis)], sample[static_cast<size_t>(axis)])) {
    neighbour[static_cast<size_t>(axis)] = k;
    for_each_beside(space, sample, axis + 1, neighbour, body);
  }
}

int size_limit(const LayoutOptions& options) { return std::max(kSizeStep, options.max_size / kSizeStep * kSizeStep); }

int fitted_size(float texels, int limit) {
  if (!(texels < static_cast<float>(limit))) return limit;
  return std::clamp(static_cast<int>(std::ceil(texels / kSizeStep)) * kSizeStep, kSizeStep, limit);
}

VisibleSurface together_of(std::span<const VisibleSurface* const> surfaces, const std::vector<int>& states) {
  VisibleSurface together;
  for (const int state : states) together.merge(*surfaces[static_cast<size_t>(state)]);
  return together;
}

using Patches = std::vector<VisibleSurface>;  // of a region
using Fits = std::vector<TextureFit>;         // likewise, per patch

std::vector<Fits> fit_all(const std::vector<Patches>& regions, const TextureFitOptions& options, std::span<const float> aspects) {
  std::vector<Fits> fits(regions.size());
  tbb::parallel_for(size_t{0}, regions.size(), [&](size_t r) {
    fits[r].resize(regions[r].size());
    for (size_t k = 0; k < fits[r].size(); ++k)
      if (regions[r][k].visible()) fits[r][k] = fit_texture(regions[r][k], options, aspects.empty() ? 0 : aspects[k]);
  });
  return fits;
}

float middle_aspect(const std::vector<Fits>& fits, size_t patch) {
  std::vector<float> aspects;
  for (const Fits& region : fits)
    if (const glm::vec2& size = region[patch].size; size.y > 0) aspects.push_back(std::max(1.0f, size.x / size.y));
  if (aspects.empty()) return 1;
  std::nth_element(aspects.begin(), aspects.begin() + static_cast<ptrdiff_t>(aspects.size() / 2), aspects.end());
  return aspects[aspects.size() / 2];
}

// Rooms that patches take: each with half a gutter around it, of which what is more than a margin may lie outside the texture.
struct Rooms {
  int gutter = 0;

  int overhang() const { return gutter - 2 * kTextureMargin; }
  TextureSize grown(const TextureSize& texture) const { return {texture.width + overhang(), texture.height + overhang()}; }

  // Of a region's patches, scaled along u and v.
  std::vector<glm::ivec2> sizes(const Fits& fits, const glm::vec2& scale, const TextureSize& texture) const {
    const TextureSize most = grown(texture);
    std::vector<glm::ivec2> sizes;
    for (const TextureFit& fit : fits)
      sizes.push_back(fit.size.x > 0 ? glm::ivec2(glm::min(glm::ceil(scale * fit.size) + static_cast<float>(gutter),
                                                           glm::vec2(most.width, most.height)))
                                     : glm::ivec2(0));
    return sizes;
  }
};

// How large textures are that hold all patches of every region, and by how much these had to be scaled for it.
struct CommonTexture {
  TextureSize size;
  float scale = 1;
  int64_t texels() const { return static_cast<int64_t>(size.width) * size.height; }
};
CommonTexture common_texture(const std::vector<Fits>& regions, const Rooms& rooms, int limit) {
  for (float scale = 1;; scale *= kShrink) {
    std::vector<std::vector<glm::ivec2>> sets;
    for (const Fits& fits : regions) sets.push_back(rooms.sizes(fits, glm::vec2(scale), {limit, limit}));
    if (const auto size = smallest_texture(sets, rooms.overhang(), kSizeStep, limit)) return {*size, scale};
  }
}

// The patches of a region grow into what room their texture has left: along u, then along v.
std::vector<TextureSlot> fill_texture(const Fits& fits, const Rooms& rooms, const CommonTexture& texture) {
  glm::vec2 scale(texture.scale);
  const auto places_at = [&](const glm::vec2& at) {
    return pack_rectangles(rooms.sizes(fits, at, texture.size), rooms.grown(texture.size));
  };
  for (int dimension = 0; dimension < 2; ++dimension) {
    glm::vec2 grown = scale;
    float low = scale[dimension], high = kMostGrowth * low;
    for (int step = 0; step < kGrowthSteps; ++step) {
      grown[dimension] = step == 0 ? high : (low + high) / 2;
      (places_at(grown) ? low : high) = grown[dimension];
    }
    scale[dimension] = low;
  }
  const std::vector<glm::ivec2> sizes = rooms.sizes(fits, scale, texture.size), places = places_at(scale).value();
  std::vector<TextureSlot> slots;
  for (size_t k = 0; k < fits.size(); ++k)
    slots.push_back({places[k] + (rooms.gutter - rooms.overhang()) / 2, sizes[k] - rooms.gutter});
  return slots;
}

// What is not seen of a patch shows one colour of what is, wherever it should come into view.
TextureMap texture_map(const Fits& fits, const Rooms& rooms, const CommonTexture& texture) {
  const std::vector<TextureSlot> slots = fill_texture(fits, rooms, texture);
  const auto area = [](const TextureSlot& slot) { return slot.size.x * slot.size.y; };
  const TextureSlot& largest = *std::max_element(slots.begin(), slots.end(),
                                                 [&](const TextureSlot& a, const TextureSlot& b) { return area(a) < area(b); });
  const glm::vec2 middle = glm::vec2(largest.low) + 0.5f * glm::vec2(largest.size);
  TextureMap map(PatchMap{{}, glm::mat2(0), middle / glm::vec2(texture.size.width, texture.size.height)});
  map.patch_count = static_cast<int>(fits.size());
  for (size_t k = 0; k < kMaxPatches; ++k) {
    const size_t patch = std::min(k, fits.size() - 1);
    if (fits[patch].size.x > 0) map.patches[k] = map_of(fits[patch], slots[patch], texture.size);
  }
  return map;
}

std::vector<int> all_states(size_t count) {
  std::vector<int> states(count);
  std::iota(states.begin(), states.end(), 0);
  return states;
}

// What blocks of a field are seen in, each set of states once, and which of them each block's is.
struct Regions {
  std::vector<std::vector<int>> states;
  std::vector<uint16_t> of_blocks;
};
Regions regions_of(const StateTable& states, const ParameterSpace& space, size_t state_count, const LayoutOptions& options,
                   const Field& field) {
  std::vector<std::vector<int>> blocks = states_of_blocks(states, space, field);
  if (options.one_map) blocks.assign(1, all_states(state_count));
  std::map<std::vector<int>, uint16_t> numbers;
  Regions regions;
  for (auto& block : blocks) {
    if (numbers.size() > kMostMaps)
      throw InputError("textures", "a field's blocks are seen in more ways than an image can hold",
                       "use fewer samples along an axis");
    const auto [at, is_new] = numbers.emplace(block, static_cast<uint16_t>(numbers.size()));
    if (is_new) regions.states.push_back(std::move(block));
    regions.of_blocks.push_back(at->second);
  }
  return regions;
}

void lay_out_whole(std::span<const VisibleSurface* const> surfaces, const LayoutOptions& options, Field& field) {
  VisibleSurface together;
  for (const VisibleSurface* surface : surfaces) together.merge(*surface);
  glm::vec2 size = together.visible() ? whole_domain_size(together, options.fit) : glm::vec2(0);
  if (options.layout == TextureLayout::kSquareDomain) size = glm::vec2(std::max(size.x, size.y));
  field.texture_width = fitted_size(size.x, size_limit(options));
  field.texture_height = fitted_size(size.y, size_limit(options));
  field.maps.assign(1, {});
  field.block_maps.clear();
}

}  // namespace

std::vector<std::vector<int>> states_of_blocks(const StateTable& states, const ParameterSpace& space, const Field& field) {
  const FieldShape shape = blocks_of(field);
  std::vector<std::set<int>> sets(static_cast<size_t>(shape.block_count()));
  std::set<std::pair<int64_t, int>> done;  // samples of the field that differ in nothing that it depends on
  const auto show = [&](const GridIndex& at, int state) { sets[static_cast<size_t>(shape.block_of(at))].insert(state); };
  for (int64_t sample = 0; sample < static_cast<int64_t>(states.state_of_sample.size()); ++sample)
    for (const int64_t shown : shown_at(states, field, sample)) {
      const int64_t own = field_sample_of(space, field.axes, shown);
      const int state = states.state_of_sample[static_cast<size_t>(sample)];
      if (!done.emplace(own, state).second) continue;
      const GridIndex index = field.space.index_from_flat(own);
      if (state >= states.grid_states) {
        show(index, state);
        continue;
      }
      GridIndex neighbour{};
      for_each_beside(field.space, index, 0, neighbour, [&](const GridIndex& at) { show(at, state); });
    }
  std::vector<std::vector<int>> result;
  for (const auto& set : sets) result.emplace_back(set.begin(), set.end());
  return result;
}

// All textures of a field have one size, so patches that are wide beside ones that are tall waste what neither fills: they are
// also tried at one aspect.
void lay_out(const StateTable& states, const ParameterSpace& space, std::span<const VisibleSurface* const> surfaces,
             std::span<const DomainPart> patches, const LayoutOptions& options, Field& field) {
  if (options.layout != TextureLayout::kFitted) return lay_out_whole(surfaces, options, field);
  const Regions regions = regions_of(states, space, surfaces.size(), options, field);
  std::vector<Patches> seen;
  for (const auto& region : regions.states) {
    const VisibleSurface together = together_of(surfaces, region);
    Patches& own = seen.emplace_back();
    for (const DomainPart& patch : patches) own.push_back(together.within(patch));
  }
  const Rooms rooms{gutter_of(options.fit)};
  TextureFitOptions fit = options.fit;
  if (patches.size() > 1) fit.stretch_bound /= kPatchReserve;
  std::vector<Fits> fits = fit_all(seen, fit, {});
  CommonTexture texture = common_texture(fits, rooms, size_limit(options));
  if (seen.size() > 1) {
    std::vector<float> aspects;
    for (size_t k = 0; k < patches.size(); ++k) aspects.push_back(middle_aspect(fits, k));
    std::vector<Fits> alike = fit_all(seen, fit, aspects);
    const CommonTexture other = common_texture(alike, rooms, size_limit(options));
    if (other.texels() < texture.texels()) fits = std::move(alike), texture = other;
  }
  field.texture_width = texture.size.width;
  field.texture_height = texture.size.height;
  field.maps.clear();
  for (const Fits& region : fits) field.maps.push_back(texture_map(region, rooms, texture));
  field.block_maps = field.maps.size() > 1 ? regions.of_blocks : std::vector<uint16_t>{};
}

std::vector<DomainPart> patches_for(const StateTable& states, const ParameterSpace& space,
                                    std::span<const VisibleSurface* const> surfaces, const LayoutOptions& options,
                                    std::span<const Field* const> fields) {
  std::vector<WeightedSurface> shown;
  for (const Field* field : fields) {
    const Regions regions = regions_of(states, space, surfaces.size(), options, *field);
    const size_t count = std::min(regions.states.size(), kRegionsOfField);
    for (size_t i = 0; i < count; ++i) {
      VisibleSurface together = together_of(surfaces, regions.states[(2 * i + 1) * regions.states.size() / (2 * count)]);
      if (together.visible()) shown.push_back({std::move(together), 1 / static_cast<double>(count)});
    }
  }
  return choose_patches(shown, options.fit);
}

}  // namespace vitrine
