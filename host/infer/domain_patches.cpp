// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/domain_patches.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>

#include "host/infer/texture_coordinates.h"

namespace vitrine {
namespace {

constexpr int kLineStep = 4;          // coarse cells between lines that are tried first
constexpr double kWorthwhile = 0.95;  // of the texels without it, at most: a cut also costs what packing and coding lose

using Demands = std::vector<PatchDemand>;  // per region

struct Half {
  DomainPart part;
  Demands demands;
};
using Split = std::array<Half, 2>;

struct Leaf {
  DomainPart part;
  Demands demands;
  std::vector<VisibleSurface> surfaces;  // per region
  std::vector<Split> splits;
};

Demands demands_within(std::span<const VisibleSurface> surfaces, const DomainPart& part) {
  Demands demands;
  for (const VisibleSurface& surface : surfaces) demands.push_back(demand_of(surface.within(part)));
  return demands;
}

Split split_at(std::span<const VisibleSurface> surfaces, const DomainPart& part, int dimension, int line) {
  DomainPart low = part, high = part;
  low.high[dimension] = high.low[dimension] = line;
  return {{{low, demands_within(surfaces, low)}, {high, demands_within(surfaces, high)}}};
}

// Texels, with gutters, of a region's patches: those of `leaves` but the one at `replaced`, and the two of `split`.
class Costs {
 public:
  Costs(std::span<const WeightedSurface> regions, const TextureFitOptions& options)
      : regions_(regions), scale_(static_cast<double>(options.texels_per_pixel)), gutter_(gutter_of(options)) {}

  double without_split(std::span<const Leaf> leaves) const { return of(leaves, leaves.size(), {}); }
  double with_split(std::span<const Leaf> leaves, size_t replaced, const Split& split) const {
    return of(leaves, replaced, split);
  }

 private:
  double of(std::span<const Leaf> leaves, size_t replaced, std::span<const Half> halves) const {
    double sum = 0;
    for (size_t r = 0; r < regions_.size(); ++r) {
      Demands demands;
      for (size_t i = 0; i < leaves.size(); ++i)
        if (i != replaced) demands.push_back(leaves[i].demands[r]);
      for (const Half& half : halves) demands.push_back(half.demands[r]);
      sum += regions_[r].weight * texels_of(demands);
    }
    return sum;
  }

  double texels_of(const Demands& demands) const {
    double texels = 0;
    for (const PatchDemand& demand : demands)
      if (demand.texels > 0) texels += scale_ * scale_ * demand.texels + gutter_ * scale_ * demand.girth + gutter_ * gutter_;
    return texels;
  }

  std::span<const WeightedSurface> regions_;
  double scale_, gutter_;
};

std::vector<Split> splits_of(const Leaf& leaf) {
  std::vector<std::array<int, 2>> lines;
  for (int dimension = 0; dimension < 2; ++dimension)
    for (int line = leaf.part.low[dimension] / kLineStep * kLineStep + kLineStep; line < leaf.part.high[dimension];
         line += kLineStep)
      lines.push_back({dimension, line});
  std::vector<Split> splits(lines.size());
  tbb::parallel_for(size_t{0}, lines.size(),
                    [&](size_t i) { splits[i] = split_at(leaf.surfaces, leaf.part, lines[i][0], lines[i][1]); });
  return splits;
}

Leaf make_leaf(std::span<const VisibleSurface> surfaces, Half half) {
  Leaf leaf{half.part, std::move(half.demands), {}, {}};
  for (const VisibleSurface& surface : surfaces) leaf.surfaces.push_back(surface.within(half.part));
  leaf.splits = splits_of(leaf);
  return leaf;
}

struct Choice {
  size_t leaf = 0;
  Split split;
  double texels = 0;
};

Choice best_split(std::span<const Leaf> leaves, const Costs& costs) {
  Choice best{0, {}, costs.without_split(leaves)};
  for (size_t i = 0; i < leaves.size(); ++i)
    for (const Split& split : leaves[i].splits)
      if (const double texels = costs.with_split(leaves, i, split); texels < best.texels) best = {i, split, texels};
  return best;
}

// Also with lines between those that were tried.
void refine(std::span<const Leaf> leaves, const Costs& costs, Choice& best) {
  const Leaf& leaf = leaves[best.leaf];
  const int dimension = best.split[0].part.high.x != leaf.part.high.x ? 0 : 1, middle = best.split[0].part.high[dimension];
  for (int line = middle - kLineStep + 1; line < middle + kLineStep; ++line) {
    if (line == middle || line <= leaf.part.low[dimension] || line >= leaf.part.high[dimension]) continue;
    Split split = split_at(leaf.surfaces, leaf.part, dimension, line);
    if (const double texels = costs.with_split(leaves, best.leaf, split); texels < best.texels)
      best.split = std::move(split), best.texels = texels;
  }
}

}  // namespace

std::vector<DomainPart> choose_patches(std::span<const WeightedSurface> regions, const TextureFitOptions& options) {
  const Costs costs(regions, options);
  std::vector<VisibleSurface> whole;
  for (const WeightedSurface& region : regions) whole.push_back(region.surface);
  std::vector<Leaf> leaves{make_leaf(whole, {VisibleSurface::kWholeDomain, demands_within(whole, VisibleSurface::kWholeDomain)})};
  while (leaves.size() < size_t{kMaxPatches}) {
    Choice best = best_split(leaves, costs);
    if (!(best.texels < costs.without_split(leaves))) break;
    refine(leaves, costs, best);
    if (best.texels > kWorthwhile * costs.without_split(leaves)) break;
    const std::vector<VisibleSurface> surfaces = std::move(leaves[best.leaf].surfaces);
    leaves[best.leaf] = make_leaf(surfaces, std::move(best.split[0]));
    leaves.push_back(make_leaf(surfaces, std::move(best.split[1])));
  }
  std::vector<DomainPart> patches;
  for (const Leaf& leaf : leaves) patches.push_back(leaf.part);
  return patches;
}

}  // namespace vitrine
