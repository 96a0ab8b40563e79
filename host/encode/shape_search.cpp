// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/shape_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/encode/forward_transform.h"

namespace vitrine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr float kBitsOfOne = 6.0f;  // of a coefficient of magnitude one: its place, size and sign

// The lattice of cell sizes: one point per combination of powers of two, numbered with the last axis fastest; point 0 has
// cells of one sample.
class CellLattice {
 public:
  explicit CellLattice(const FieldShape& shape) : axes_(shape.space.axis_count) {
    for (int a = 0; a < axes_; ++a) {
      int log2 = 0;
      while ((1 << log2) < shape.block_size[static_cast<size_t>(a)]) ++log2;
      log2_[static_cast<size_t>(a)] = log2;
      count_ *= log2 + 1;
    }
  }
  int count() const { return count_; }
  AxisSizes cell(int point) const {
    AxisSizes cell{};
    for (int a = axes_ - 1; a >= 0; --a) {
      const int n = log2_[static_cast<size_t>(a)] + 1;
      cell[static_cast<size_t>(a)] = static_cast<uint8_t>(1 << (point % n));
      point /= n;
    }
    return cell;
  }
  bool contains(int coarse, int fine) const {
    const AxisSizes c = cell(coarse), f = cell(fine);
    for (size_t a = 0; a < static_cast<size_t>(axes_); ++a) {
      if (c[a] < f[a]) return false;
    }
    return coarse != fine;
  }

 private:
  int axes_;
  std::array<int, kMaxAxes> log2_{};
  int count_ = 1;
};

// The part of the grid that one block covers.
struct BlockBox {
  GridIndex first{}, size{};  // size 1 beyond the field's axes
  int samples() const { return size[0] * size[1] * size[2] * size[3]; }
};

BlockBox box_of(const FieldShape& shape, int block) {
  BlockBox box;
  box.size.fill(1);
  for (int a = shape.space.axis_count - 1; a >= 0; --a) {
    const size_t i = static_cast<size_t>(a);
    const int blocks = shape.blocks_along(a), start = block % blocks * shape.block_size[i] - shape.stagger[i];
    box.first[i] = std::max(start, 0);
    box.size[i] = std::min(start + shape.block_size[i], shape.space.axes[i].samples) - box.first[i];
    block /= blocks;
  }
  return box;
}

// A tile's coefficients averaged over cells of one size: one vector per cell.
struct CellMeans {
  GridIndex cells{};  // per axis
  std::vector<int> samples;
  std::vector<std::vector<float>> mean;
};

class TileAnalysis {
 public:
  TileAnalysis(const CellLattice& lattice, const FieldShape& shape, const FieldTextures& textures,
               const std::vector<float>& cell_importance, int log2, double price)
      : lattice_(lattice), shape_(shape), textures_(textures), cell_importance_(cell_importance), log2_(log2), price_(price) {}

  // Adds the costs of all steps for the tile at (x, y) of a block to `cost` (coarse * count + fine; coarse == count: the top)
  // and the bits of it to `bits`.
  void add(const BlockBox& box, int x, int y, std::vector<double>& cost, std::vector<double>& bits) const {
    const int count = lattice_.count();
    std::vector<CellMeans> means(static_cast<size_t>(count));
    const auto leaves = transform_leaves(box, x, y);
    for (int p = 0; p < count; ++p) means[static_cast<size_t>(p)] = means_of(box, leaves, lattice_.cell(p));
    const double weight = weight_at(x, y);
    for (int fine = 0; fine < count; ++fine) {
      for (int coarse = 0; coarse <= count; ++coarse) {
        if (coarse < count && !lattice_.contains(coarse, fine)) continue;
        const size_t at = static_cast<size_t>(coarse * count + fine);
        add_step(coarse < count ? &means[static_cast<size_t>(coarse)] : nullptr, means[static_cast<size_t>(fine)],
                 lattice_.cell(coarse % count), lattice_.cell(fine), weight, cost[at], bits[at]);
      }
    }
  }

 private:
  size_t area() const { return size_t{1} << (2 * log2_); }

  double weight_at(int x, int y) const {
    const int columns = (textures_.width + kCellSize - 1) / kCellSize;
    return cell_importance_[static_cast<size_t>(y / kCellSize * columns + x / kCellSize)] / textures_.reference_importance;
  }

  // Per sample of the box, row-major: coefficients of the three planes, each scaled by the root of its weight.
  std::vector<std::vector<float>> transform_leaves(const BlockBox& box, int x, int y) const {
    std::vector<std::vector<float>> leaves;
    for (int s = 0; s < box.samples(); ++s) {
      GridIndex at{};
      for (int a = kMaxAxes - 1, rest = s; a >= 0; --a) {
        at[static_cast<size_t>(a)] = box.first[static_cast<size_t>(a)] + rest % box.size[static_cast<size_t>(a)];
        rest /= box.size[static_cast<size_t>(a)];
      }
      leaves.push_back(transform_tile(textures_.leaves[static_cast<size_t>(shape_.space.flat_from_index(at))], x, y));
    }
    return leaves;
  }

  std::vector<float> transform_tile(const CodedPlanes& planes, int x, int y) const {
    const int size = 1 << log2_;
    const size_t texels = static_cast<size_t>(textures_.width) * static_cast<size_t>(textures_.height);
    std::vector<float> out(kNodePlanes * area()), values(area());
    for (size_t p = 0; p < kNodePlanes; ++p) {
      const float scale = std::sqrt(kPlaneWeights[p]);
      for (int row = 0; row < size; ++row) {
        const size_t line =
            p * texels + static_cast<size_t>(std::min(y + row, textures_.height - 1)) * static_cast<size_t>(textures_.width);
        for (int i = 0; i < size; ++i)
          values[static_cast<size_t>(row * size + i)] =
              scale * planes[line + static_cast<size_t>(std::min(x + i, textures_.width - 1))];
      }
      forward_transform(values.data(), log2_, &out[p * area()]);
    }
    return out;
  }

  CellMeans means_of(const BlockBox& box, const std::vector<std::vector<float>>& leaves, const AxisSizes& cell) const {
    CellMeans means;
    int count = 1;
    for (size_t a = 0; a < kMaxAxes; ++a) {
      const int width = std::max<int>(cell[a], 1);
      means.cells[a] = (box.size[a] + width - 1) / width;
      count *= means.cells[a];
    }
    means.samples.assign(static_cast<size_t>(count), 0);
    means.mean.assign(static_cast<size_t>(count), std::vector<float>(kNodePlanes * area(), 0));
    for (int s = 0; s < box.samples(); ++s) {
      const size_t c = static_cast<size_t>(cell_of_sample(box, s, cell, means.cells));
      ++means.samples[c];
      for (size_t i = 0; i < means.mean[c].size(); ++i) means.mean[c][i] += leaves[static_cast<size_t>(s)][i];
    }
    for (size_t c = 0; c < means.mean.size(); ++c) {
      for (float& v : means.mean[c]) v /= static_cast<float>(means.samples[c]);
    }
    return means;
  }

  static int cell_of_sample(const BlockBox& box, int sample, const AxisSizes& cell, const GridIndex& cells) {
    int index = 0, factor = 1;
    for (int a = kMaxAxes - 1; a >= 0; --a) {
      const size_t i = static_cast<size_t>(a);
      index += sample % box.size[i] / std::max<int>(cell[i], 1) * factor;
      factor *= cells[i];
      sample /= box.size[i];
    }
    return index;
  }

  // Which coarse cell holds a fine one.
  static size_t parent_of(const CellMeans& coarse, const AxisSizes& coarse_cell, const CellMeans& fine,
                          const AxisSizes& fine_cell, size_t index) {
    int rest = static_cast<int>(index), parent = 0, factor = 1;
    for (int a = kMaxAxes - 1; a >= 0; --a) {
      const size_t i = static_cast<size_t>(a);
      parent += rest % fine.cells[i] * std::max<int>(fine_cell[i], 1) / std::max<int>(coarse_cell[i], 1) * factor;
      factor *= coarse.cells[i];
      rest /= fine.cells[i];
    }
    return static_cast<size_t>(parent);
  }

  // What coding the differences between two cell sizes costs, in units of the price of a bit.
  void add_step(const CellMeans* coarse, const CellMeans& fine, const AxisSizes& coarse_cell, const AxisSizes& fine_cell,
                double weight, double& cost, double& bits) const {
    for (size_t c = 0; c < fine.mean.size(); ++c) {
      // u = coefficient / step, step^2 = price / (kPricePerStep2 * reference * samples).
      const float per_step =
          static_cast<float>(std::sqrt(fine.samples[c] * kPricePerStep2 * textures_.reference_importance / price_));
      const float* mean = fine.mean[c].data();
      const float* from = coarse ? coarse->mean[parent_of(*coarse, coarse_cell, fine, fine_cell, c)].data() : nullptr;
      const float scale = static_cast<float>(weight / kPricePerStep2);
      float step_cost = 0, step_bits = 0;
      for (size_t i = 0; i < fine.mean[c].size(); ++i) {
        const float u = std::fabs(mean[i] - (from ? from[i] : 0)) * per_step;
        const float zero = scale * u * u;
        if (u < 0.5f) {
          step_cost += zero;
          continue;
        }
        const float coded_bits = kBitsOfOne + 2 * std::max(0.0f, std::log2(u)), coded = scale / 12 + coded_bits;
        step_cost += std::min(zero, coded);
        if (coded < zero) step_bits += coded_bits;
      }
      cost += static_cast<double>(step_cost);
      bits += static_cast<double>(step_bits);
    }
  }

  const CellLattice& lattice_;
  const FieldShape& shape_;
  const FieldTextures& textures_;
  const std::vector<float>& cell_importance_;
  int log2_;
  double price_;
};

// Tiles with some importance, evenly spread, at most `count` of them.
std::vector<std::pair<int, int>> choose_tiles(const FieldTextures& textures, const std::vector<float>& cell_importance, int size,
                                              size_t count) {
  std::vector<std::pair<int, int>> tiles, chosen;
  const float floor = *std::min_element(cell_importance.begin(), cell_importance.end());
  const int columns = (textures.width + kCellSize - 1) / kCellSize;
  for (int pass = 0; pass < 2 && tiles.empty(); ++pass) {
    for (int y = 0; y < textures.height; y += size) {
      for (int x = 0; x < textures.width; x += size) {
        const float w = cell_importance[static_cast<size_t>(y / kCellSize * columns + x / kCellSize)];
        if (pass == 1 || w > 1.01f * floor) tiles.emplace_back(x, y);
      }
    }
  }
  count = std::min(count, tiles.size());
  for (size_t i = 0; i < count; ++i) chosen.push_back(tiles[(2 * i + 1) * tiles.size() / (2 * count)]);
  return chosen;
}

// Coefficients that one tile needs compared, per texel of it.
int64_t comparisons(const CellLattice& lattice, const BlockBox& box) {
  int64_t total = 0;
  for (int fine = 0; fine < lattice.count(); ++fine) {
    const AxisSizes cell = lattice.cell(fine);
    int64_t cells = 1, parents = 1;
    for (size_t a = 0; a < kMaxAxes; ++a) cells *= (box.size[a] + std::max<int>(cell[a], 1) - 1) / std::max<int>(cell[a], 1);
    for (int coarse = 0; coarse < lattice.count(); ++coarse) parents += lattice.contains(coarse, fine);
    total += cells * parents;
  }
  return total;
}

// The cheapest chain that ends in cells of one sample.
std::vector<int> shortest_chain(const CellLattice& lattice, const std::vector<double>& cost) {
  const size_t count = static_cast<size_t>(lattice.count());
  std::vector<std::vector<double>> best(kMaxChain, std::vector<double>(count, kInfinity));
  std::vector<std::vector<int>> from(kMaxChain, std::vector<int>(count, -1));
  for (size_t p = 0; p < count; ++p) best[0][p] = cost[count * count + p];
  for (size_t k = 1; k < kMaxChain; ++k) {
    for (size_t fine = 0; fine < count; ++fine) {
      for (size_t coarse = 0; coarse < count; ++coarse) {
        if (!lattice.contains(static_cast<int>(coarse), static_cast<int>(fine))) continue;
        const double total = best[k - 1][coarse] + cost[coarse * count + fine];
        if (total < best[k][fine]) best[k][fine] = total, from[k][fine] = static_cast<int>(coarse);
      }
    }
  }
  size_t length = 0;
  for (size_t k = 1; k < kMaxChain; ++k) {
    if (best[k][0] < best[length][0] * 0.998) length = k;  // one more level must be worth its decoding
  }
  std::vector<int> chain{0};
  for (size_t k = length; k > 0; --k) chain.insert(chain.begin(), from[k][static_cast<size_t>(chain.front())]);
  return chain;
}

// The block with most samples, the first of them.
int largest_block(const FieldShape& shape) {
  int best = 0;
  for (int b = 0; b < shape.block_count(); ++b) {
    if (box_of(shape, b).samples() > box_of(shape, best).samples()) best = b;
  }
  return best;
}

}  // namespace

ShapeChoice choose_pyramid(const FieldShape& shape, const FieldTextures& textures, double price, double table_bits,
                           int64_t work) {
  const CellLattice lattice(shape);
  const size_t count = static_cast<size_t>(lattice.count());
  const int block = largest_block(shape);
  const BlockBox box = box_of(shape, block);
  const std::vector<float>& importance = textures.weights_of(block).cell_importance;
  const int log2 = box.samples() > 256 ? 3 : 4;
  const int64_t per_tile = comparisons(lattice, box) * kNodePlanes << (2 * log2);
  const auto tiles =
      choose_tiles(textures, importance, 1 << log2, static_cast<size_t>(std::clamp<int64_t>(work / per_tile, 2, 48)));
  const TileAnalysis analysis(lattice, shape, textures, importance, log2, price);
  std::vector<std::vector<double>> costs(tiles.size(), std::vector<double>((count + 1) * count, 0)), bits = costs;
  tbb::parallel_for(size_t{0}, tiles.size(),
                    [&](size_t t) { analysis.add(box, tiles[t].first, tiles[t].second, costs[t], bits[t]); });
  std::vector<double> cost((count + 1) * count, 0), bit(cost);
  for (size_t t = 0; t < tiles.size(); ++t) {
    for (size_t i = 0; i < cost.size(); ++i) cost[i] += costs[t][i], bit[i] += bits[t][i];
  }
  const double texels = static_cast<double>(textures.width) * textures.height,
               share = static_cast<double>(tiles.size() << (2 * log2)) / texels;
  for (size_t i = 0; i < cost.size(); ++i) {
    const AxisSizes cell = lattice.cell(static_cast<int>(i % count));
    double cells = 1;
    for (int a = 0; a < shape.space.axis_count; ++a)
      cells *= shape.block_size[static_cast<size_t>(a)] / cell[static_cast<size_t>(a)];
    cost[i] += share * table_bits * cells;
  }
  const std::vector<int> chain = shortest_chain(lattice, cost);
  ShapeChoice choice;
  choice.pyramid.level_count = static_cast<int>(chain.size());
  for (size_t l = 0; l < chain.size(); ++l) {
    choice.pyramid.cell[l] = lattice.cell(chain[l]);
    choice.bits += bit[(l > 0 ? static_cast<size_t>(chain[l - 1]) : count) * count + static_cast<size_t>(chain[l])];
  }
  choice.bits *= shape.block_count() / std::max(share, 1e-9);
  return choice;
}

}  // namespace vitrine
