// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/axis_smoothing.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace vitrine {
namespace {

constexpr int kSweeps = 24;     // of Gauss and Seidel: three times through a block
constexpr float kHold = 1e-3f;  // precision of what no sample sees: keeps what inference filled in
constexpr size_t kTexelsAtOnce = 256;

// Pairs of samples of the box, by their place in it.
std::vector<std::vector<size_t>> neighbours_of(const ParameterSpace& space, const FieldShape::Box& box) {
  std::array<size_t, kMaxAxes> stride{};
  size_t count = 1;
  for (int a = space.axis_count - 1; a >= 0; --a) {
    stride[static_cast<size_t>(a)] = count;
    count *= static_cast<size_t>(box.last[static_cast<size_t>(a)] - box.first[static_cast<size_t>(a)] + 1);
  }
  std::vector<std::vector<size_t>> neighbours(count);
  for (size_t s = 0; s < count; ++s)
    for (size_t a = 0; a < static_cast<size_t>(space.axis_count); ++a) {
      if (space.axes[a].kind == AxisKind::kDiscrete) continue;
      const auto size = static_cast<size_t>(box.last[a] - box.first[a] + 1), at = s / stride[a] % size;
      if (at > 0) neighbours[s].push_back(s - stride[a]);
      if (at + 1 < size) neighbours[s].push_back(s + stride[a]);
    }
  return neighbours;
}

void sweep(const std::vector<std::vector<size_t>>& neighbours, float strength, size_t first, size_t last,
           const std::vector<std::vector<glm::vec3>>& inferred, std::vector<SmoothedTexture>& textures) {
  for (size_t s = 0; s < textures.size(); ++s)
    for (size_t i = first; i < last; ++i) {
      const float own = textures[s].precision[i] + kHold;
      glm::vec3 sum = own * inferred[s][i - first];
      for (const size_t t : neighbours[s]) sum += strength * textures[t].texels[i];
      textures[s].texels[i] = sum / (own + strength * static_cast<float>(neighbours[s].size()));
    }
}

}  // namespace

void smooth_over_axes(const ParameterSpace& space, const FieldShape::Box& box, float strength,
                      std::vector<SmoothedTexture>& textures) {
  const auto neighbours = neighbours_of(space, box);
  const size_t texels = textures.empty() ? 0 : textures.front().texels.size();
  tbb::parallel_for(size_t{0}, (texels + kTexelsAtOnce - 1) / kTexelsAtOnce, [&](size_t part) {
    const size_t first = part * kTexelsAtOnce, last = std::min(texels, first + kTexelsAtOnce);
    std::vector<std::vector<glm::vec3>> inferred;
    for (const SmoothedTexture& t : textures)
      inferred.emplace_back(t.texels.begin() + static_cast<ptrdiff_t>(first), t.texels.begin() + static_cast<ptrdiff_t>(last));
    for (int k = 0; k < kSweeps; ++k) sweep(neighbours, strength, first, last, inferred, textures);
  });
}

}  // namespace vitrine
