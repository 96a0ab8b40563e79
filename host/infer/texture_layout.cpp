// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/texture_layout.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "host/base/error.h"

namespace vitrine {
namespace {

constexpr int kSizeStep = 8;
constexpr size_t kMostMaps = 65535;  // formats/SPEC.md

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

int fitted_size(float texels, int max_size) {
  const int limit = std::max(kSizeStep, max_size / kSizeStep * kSizeStep);
  if (!(texels < static_cast<float>(limit))) return limit;
  return std::clamp(static_cast<int>(std::ceil(texels / kSizeStep)) * kSizeStep, kSizeStep, limit);
}

VisibleSurface together_of(std::span<const VisibleSurface* const> surfaces, const std::vector<int>& states) {
  VisibleSurface together;
  for (const int state : states) together.merge(*surfaces[static_cast<size_t>(state)]);
  return together;
}

std::vector<TextureFit> fit_all(const std::vector<VisibleSurface>& regions, const TextureFitOptions& options, float aspect) {
  std::vector<TextureFit> fits(regions.size());
  tbb::parallel_for(size_t{0}, regions.size(), [&](size_t r) {
    if (regions[r].visible()) fits[r] = fit_texture(regions[r], options, aspect);
  });
  return fits;
}

glm::vec2 largest_size(const std::vector<TextureFit>& fits) {
  glm::vec2 size(0);
  for (const TextureFit& fit : fits) size = glm::max(size, fit.size);
  return size;
}

float middle_aspect(const std::vector<TextureFit>& fits) {
  std::vector<float> aspects;
  for (const TextureFit& fit : fits)
    if (fit.size.y > 0) aspects.push_back(std::max(1.0f, fit.size.x / fit.size.y));
  if (aspects.empty()) return 1;
  std::nth_element(aspects.begin(), aspects.begin() + static_cast<ptrdiff_t>(aspects.size() / 2), aspects.end());
  return aspects[aspects.size() / 2];
}

// All textures of a field have one size, so one that is wide beside one that is tall wastes what neither fills: they are also
// tried at one aspect.
std::vector<TextureFit> fit_together(const std::vector<VisibleSurface>& regions, const TextureFitOptions& options) {
  std::vector<TextureFit> free = fit_all(regions, options, 0);
  if (regions.size() == 1) return free;
  std::vector<TextureFit> alike = fit_all(regions, options, middle_aspect(free));
  const auto area = [](const glm::vec2& size) { return size.x * size.y; };
  return area(largest_size(alike)) < area(largest_size(free)) ? alike : free;
}

std::vector<int> all_states(size_t count) {
  std::vector<int> states(count);
  std::iota(states.begin(), states.end(), 0);
  return states;
}

void lay_out_whole(std::span<const VisibleSurface* const> surfaces, const LayoutOptions& options, Field& field) {
  VisibleSurface together;
  for (const VisibleSurface* surface : surfaces) together.merge(*surface);
  glm::vec2 size = together.visible() ? whole_domain_size(together, options.fit) : glm::vec2(0);
  if (options.layout == TextureLayout::kSquareDomain) size = glm::vec2(std::max(size.x, size.y));
  field.texture_width = fitted_size(size.x, options.max_size);
  field.texture_height = fitted_size(size.y, options.max_size);
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

void lay_out(const StateTable& states, const ParameterSpace& space, std::span<const VisibleSurface* const> surfaces,
             const LayoutOptions& options, Field& field) {
  if (options.layout != TextureLayout::kFitted) return lay_out_whole(surfaces, options, field);
  std::vector<std::vector<int>> blocks = states_of_blocks(states, space, field);
  if (options.one_map) blocks.assign(1, all_states(surfaces.size()));
  std::map<std::vector<int>, uint16_t> numbers;
  field.block_maps.clear();
  for (const auto& block : blocks) {
    if (numbers.size() > kMostMaps)
      throw InputError("textures", "a field's blocks are seen in more ways than an image can hold",
                       "use fewer samples along an axis");
    field.block_maps.push_back(numbers.emplace(block, static_cast<uint16_t>(numbers.size())).first->second);
  }
  std::vector<VisibleSurface> regions(numbers.size());
  for (const auto& [region, number] : numbers) regions[number] = together_of(surfaces, region);
  const std::vector<TextureFit> fits = fit_together(regions, options.fit);
  const glm::vec2 size = largest_size(fits);
  field.texture_width = fitted_size(size.x + 2 * kTextureMargin, options.max_size);
  field.texture_height = fitted_size(size.y + 2 * kTextureMargin, options.max_size);
  field.maps.clear();
  for (const TextureFit& fit : fits)
    field.maps.push_back(fit.size.x > 0 ? map_of(fit, field.texture_width, field.texture_height) : TextureMap{});
  if (field.maps.size() == 1) field.block_maps.clear();
}

}  // namespace vitrine
