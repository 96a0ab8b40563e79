// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/axis_smoothing.h"

#include <algorithm>
#include <array>
#include <glm/vec4.hpp>

namespace vitrine {
namespace {

constexpr int kSweeps = 12;     // of Gauss and Seidel: there and back

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

using TexelsOfSamples = std::vector<std::vector<glm::vec3>>;

// Samples that chains of neighbours join have the same number: that of the first of them.
std::vector<size_t> parts_of(const std::vector<std::vector<size_t>>& neighbours) {
  std::vector<size_t> parts;
  for (size_t s = 0; s < neighbours.size(); ++s) {
    size_t part = s;
    for (const size_t t : neighbours[s])
      if (t < s) part = std::min(part, parts[t]);
    parts.push_back(part);
  }
  return parts;
}

// Drawn towards the mean of what the joined samples determine, from where the sweeps have not far to go.
void start(const std::vector<size_t>& parts, float strength, const TexelsOfSamples& inferred,
           std::vector<SolvedTexture>& textures) {
  for (size_t i = 0; i < textures[0].texels.size(); ++i) {
    std::vector<glm::vec4> sums(textures.size(), glm::vec4(0));
    for (size_t s = 0; s < textures.size(); ++s)
      sums[parts[s]] += (textures[s].precision[i] + textures[s].hold) * glm::vec4(inferred[s][i], 1);
    for (size_t s = 0; s < textures.size(); ++s) {
      const float own = textures[s].precision[i] + textures[s].hold;
      const glm::vec4& sum = sums[parts[s]];
      textures[s].texels[i] = (own * inferred[s][i] + strength / sum.w * glm::vec3(sum)) / (own + strength);
    }
  }
}

void relax(size_t s, const std::vector<size_t>& neighbours, float strength, const TexelsOfSamples& inferred,
           std::vector<SolvedTexture>& textures) {
  for (size_t i = 0; i < textures[0].texels.size(); ++i) {
    const float own = textures[s].precision[i] + textures[s].hold;
    glm::vec3 sum = own * inferred[s][i];
    for (const size_t t : neighbours) sum += strength * textures[t].texels[i];
    textures[s].texels[i] = sum / (own + strength * static_cast<float>(neighbours.size()));
  }
}

}  // namespace

void smooth_over_axes(const ParameterSpace& space, const FieldShape::Box& box, float strength,
                      std::vector<SolvedTexture>& textures) {
  const auto neighbours = neighbours_of(space, box);
  const std::vector<size_t> parts = parts_of(neighbours);
  TexelsOfSamples inferred;
  for (const SolvedTexture& t : textures) inferred.push_back(t.texels);
  start(parts, strength, inferred, textures);
  for (int k = 0; k < kSweeps; ++k) {
    for (size_t s = 0; s < textures.size(); ++s) relax(s, neighbours[s], strength, inferred, textures);
    for (size_t s = textures.size(); s-- > 0;) relax(s, neighbours[s], strength, inferred, textures);
  }
}

}  // namespace vitrine
