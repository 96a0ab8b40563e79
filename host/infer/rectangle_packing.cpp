// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/rectangle_packing.h"

#include <stb/stb_rect_pack.h>

#include <algorithm>

namespace vitrine {
namespace {

int up_to(int size, int step) { return (size + step - 1) / step * step; }

// Height of a texture of this width that has room for all; above `max_height` where it has not.
int height_for(std::span<const std::vector<glm::ivec2>> sets, int width, int max_height) {
  int height = 1;
  for (const auto& sizes : sets) {
    const auto places = pack_rectangles(sizes, {width, max_height});
    if (!places) return max_height + 1;
    for (size_t i = 0; i < sizes.size(); ++i)
      if (sizes[i].x > 0) height = std::max(height, (*places)[i].y + sizes[i].y);
  }
  return height;
}

}  // namespace

std::optional<std::vector<glm::ivec2>> pack_rectangles(std::span<const glm::ivec2> sizes, const TextureSize& texture) {
  std::vector<stbrp_rect> rectangles;
  for (size_t i = 0; i < sizes.size(); ++i)
    if (sizes[i].x > 0 && sizes[i].y > 0) rectangles.push_back({static_cast<int>(i), sizes[i].x, sizes[i].y, 0, 0, 0});
  std::vector<stbrp_node> nodes(static_cast<size_t>(texture.width));
  stbrp_context context;
  stbrp_init_target(&context, texture.width, texture.height, nodes.data(), texture.width);
  if (!stbrp_pack_rects(&context, rectangles.data(), static_cast<int>(rectangles.size()))) return std::nullopt;
  std::vector<glm::ivec2> places(sizes.size());
  for (const stbrp_rect& rectangle : rectangles) places[static_cast<size_t>(rectangle.id)] = {rectangle.x, rectangle.y};
  return places;
}

std::optional<TextureSize> smallest_texture(std::span<const std::vector<glm::ivec2>> sets, int overhang, int step, int max_size) {
  std::optional<TextureSize> best;
  int widest = 1, all = 1;
  for (const auto& sizes : sets) {
    int sum = 0;
    for (const glm::ivec2& size : sizes) widest = std::max(widest, size.x), sum += size.x;
    all = std::max(all, sum);
  }
  const auto side = [&](int size) { return up_to(std::max(1, size - overhang), step); };
  for (int width = side(widest); width <= std::min(side(all), max_size); width += step) {
    const int height = side(height_for(sets, width + overhang, max_size + overhang));
    if (height > max_size) continue;
    if (!best || static_cast<int64_t>(width) * height < static_cast<int64_t>(best->width) * best->height)
      best = TextureSize{width, height};
  }
  return best;
}

}  // namespace vitrine
