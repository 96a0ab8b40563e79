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
  int axes() const { return axes_; }
  // The point whose cells are half as long along an axis, or -1.
  int halved(int point, int axis) const {
    if (cell(point)[static_cast<size_t>(axis)] < 2) return -1;
    int stride = 1;
    for (int a = axes_ - 1; a > axis; --a) stride *= log2_[static_cast<size_t>(a)] + 1;
    return point - stride;
  }
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
  GridIndex cells{}, width{};  // per axis: how many, of how many samples
  std::vector<int> samples;
  std::vector<std::vector<float>> mean;
};

// A sum for every step that a pyramid may take: from nothing to a top, from cells to finer ones by residuals, from cells to
// halves of them by differences.
class Steps {
 public:
  explicit Steps(const CellLattice& lattice)
      : count_(static_cast<size_t>(lattice.count())),
        values_(count_ * (count_ + 1) + count_ * static_cast<size_t>(lattice.axes()), 0) {}
  double& top(int fine) { return values_[static_cast<size_t>(fine)]; }
  double& residuals(int coarse, int fine) {
    return values_[(static_cast<size_t>(coarse) + 1) * count_ + static_cast<size_t>(fine)];
  }
  double& differences(int coarse, int axis) {
    return values_[(count_ + 1 + static_cast<size_t>(axis)) * count_ + static_cast<size_t>(coarse)];
  }
  void add(const Steps& other) {
    for (size_t i = 0; i < values_.size(); ++i) values_[i] += other.values_[i];
  }

 private:
  size_t count_;
  std::vector<double> values_;
};
struct StepCosts {
  explicit StepCosts(const CellLattice& lattice) : cost(lattice), bits(lattice) {}
  Steps cost;  // in units of the price of a bit
  Steps bits;
};

class TileAnalysis {
 public:
  TileAnalysis(const CellLattice& lattice, const FieldShape& shape, const FieldTextures& textures,
               const std::vector<float>& cell_importance, int log2, double price)
      : lattice_(lattice), shape_(shape), textures_(textures), cell_importance_(cell_importance), log2_(log2), price_(price) {}

  // The costs of all steps for the tile at (x, y) of a block.
  StepCosts costs_of(const BlockBox& box, int x, int y) const {
    std::vector<CellMeans> means;
    const auto leaves = transform_leaves(box, x, y);
    for (int p = 0; p < lattice_.count(); ++p) means.push_back(means_of(box, leaves, lattice_.cell(p)));
    const float scale = static_cast<float>(weight_at(x, y) / kPricePerStep2);
    StepCosts costs(lattice_);
    for (int fine = 0; fine < lattice_.count(); ++fine) {
      add_residuals(nullptr, means[static_cast<size_t>(fine)], scale, costs.cost.top(fine), costs.bits.top(fine));
      for (int coarse = 0; coarse < lattice_.count(); ++coarse)
        if (lattice_.contains(coarse, fine))
          add_residuals(&means[static_cast<size_t>(coarse)], means[static_cast<size_t>(fine)], scale,
                        costs.cost.residuals(coarse, fine), costs.bits.residuals(coarse, fine));
    }
    for (int coarse = 0; coarse < lattice_.count(); ++coarse)
      for (int axis = 0; axis < lattice_.axes(); ++axis)
        if (const int fine = lattice_.halved(coarse, axis); fine >= 0)
          add_differences(means[static_cast<size_t>(fine)], axis, scale, costs.cost.differences(coarse, axis),
                          costs.bits.differences(coarse, axis));
    return costs;
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
      means.width[a] = std::max<int>(cell[a], 1);
      means.cells[a] = (box.size[a] + means.width[a] - 1) / means.width[a];
      count *= means.cells[a];
    }
    means.samples.assign(static_cast<size_t>(count), 0);
    means.mean.assign(static_cast<size_t>(count), std::vector<float>(kNodePlanes * area(), 0));
    for (int s = 0; s < box.samples(); ++s) {
      const size_t c = static_cast<size_t>(cell_of_sample(box, s, means));
      ++means.samples[c];
      for (size_t i = 0; i < means.mean[c].size(); ++i) means.mean[c][i] += leaves[static_cast<size_t>(s)][i];
    }
    for (size_t c = 0; c < means.mean.size(); ++c) {
      for (float& v : means.mean[c]) v /= static_cast<float>(means.samples[c]);
    }
    return means;
  }

  static int cell_of_sample(const BlockBox& box, int sample, const CellMeans& means) {
    int index = 0, factor = 1;
    for (int a = kMaxAxes - 1; a >= 0; --a) {
      const size_t i = static_cast<size_t>(a);
      index += sample % box.size[i] / means.width[i] * factor;
      factor *= means.cells[i];
      sample /= box.size[i];
    }
    return index;
  }

  // Which coarse cell holds a fine one.
  static size_t parent_of(const CellMeans& coarse, const CellMeans& fine, size_t index) {
    int rest = static_cast<int>(index), parent = 0, factor = 1;
    for (int a = kMaxAxes - 1; a >= 0; --a) {
      const size_t i = static_cast<size_t>(a);
      parent += rest % fine.cells[i] * fine.width[i] / coarse.width[i] * factor;
      factor *= coarse.cells[i];
      rest /= fine.cells[i];
    }
    return static_cast<size_t>(parent);
  }

  void add_residuals(const CellMeans* coarse, const CellMeans& fine, float scale, double& cost, double& bits) const {
    std::vector<float> node(kNodePlanes * area());
    for (size_t c = 0; c < fine.mean.size(); ++c) {
      const float* from = coarse ? coarse->mean[parent_of(*coarse, fine, c)].data() : nullptr;
      for (size_t i = 0; i < node.size(); ++i) node[i] = fine.mean[c][i] - (from ? from[i] : 0);
      add_node(node, fine.samples[c], scale, cost, bits);
    }
  }

  // `fine`: the halves, pairs of neighbours along an axis.
  void add_differences(const CellMeans& fine, int axis, float scale, double& cost, double& bits) const {
    size_t stride = 1;
    for (size_t a = static_cast<size_t>(axis) + 1; a < kMaxAxes; ++a) stride *= static_cast<size_t>(fine.cells[a]);
    const size_t along = static_cast<size_t>(fine.cells[static_cast<size_t>(axis)]);
    std::vector<float> node(kNodePlanes * area());
    for (size_t c = 0; c < fine.mean.size(); ++c) {
      const size_t at = c / stride % along;
      if (at % 2 != 0 || at + 1 == along) continue;
      const std::vector<float>&first = fine.mean[c], &second = fine.mean[c + stride];
      for (size_t i = 0; i < node.size(); ++i) node[i] = (first[i] - second[i]) / 2;
      add_node(node, fine.samples[c] + fine.samples[c + stride], scale, cost, bits);
    }
  }

  // What a node of these coefficients costs that makes so many samples, in units of the price of a bit.
  // u = coefficient / step, step^2 = price / (kPricePerStep2 * reference * samples).
  void add_node(const std::vector<float>& node, int samples, float scale, double& cost, double& bits) const {
    const float per_step = static_cast<float>(std::sqrt(samples * kPricePerStep2 * textures_.reference_importance / price_));
    float node_cost = 0, node_bits = 0;
    for (const float value : node) {
      const float u = std::fabs(value) * per_step, zero = scale * u * u;
      if (u < 0.5f) {
        node_cost += zero;
        continue;
      }
      const float coded_bits = kBitsOfOne + 2 * std::max(0.0f, std::log2(u)), coded = scale / 12 + coded_bits;
      node_cost += std::min(zero, coded);
      if (coded < zero) node_bits += coded_bits;
    }
    cost += static_cast<double>(node_cost);
    bits += static_cast<double>(node_bits);
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

// The cheapest pyramid that ends in cells of one sample: a shortest path through the lattice, of so many levels at most.
class PyramidSearch {
 public:
  PyramidSearch(const CellLattice& lattice, StepCosts& costs, PyramidKind kind)
      : lattice_(lattice), costs_(costs), kind_(kind), count_(static_cast<size_t>(lattice.count())) {
    best_[0].resize(count_);
    for (int p = 0; p < lattice.count(); ++p)
      best_[0][static_cast<size_t>(p)] = {costs.cost.top(p), -1, PyramidShape::kResiduals};
    for (size_t k = 1; k < kMaxLevels; ++k) extend(k);
  }

  ShapeChoice choice() const {
    size_t last = 0;
    for (size_t k = 1; k < kMaxLevels; ++k)
      if (best_[k][0].cost < best_[last][0].cost * kWorthALevel) last = k;
    ShapeChoice result;
    result.pyramid.level_count = static_cast<int>(last) + 1;
    int point = 0;
    for (size_t level = last + 1; level-- > 0;) {
      const Arrival& arrival = best_[level][static_cast<size_t>(point)];
      const bool differences = arrival.halved != PyramidShape::kResiduals;
      result.pyramid.cell[level] = lattice_.cell(differences ? arrival.from : point);
      result.pyramid.halved[level] = arrival.halved;
      result.bits += level == 0    ? costs_.bits.top(point)
                     : differences ? costs_.bits.differences(arrival.from, arrival.halved)
                                   : costs_.bits.residuals(arrival.from, point);
      point = arrival.from;
    }
    return result;
  }

 private:
  static constexpr double kWorthALevel = 0.998;  // one more must be worth its decoding
  struct Arrival {
    double cost = kInfinity;
    int from = -1;
    int8_t halved = PyramidShape::kResiduals;
  };

  void extend(size_t k) {
    best_[k].resize(count_);
    for (int coarse = 0; coarse < lattice_.count(); ++coarse) {
      for (int fine = 0; fine < lattice_.count(); ++fine)
        if (allowed(coarse, fine)) arrive(k, coarse, fine, costs_.cost.residuals(coarse, fine), PyramidShape::kResiduals);
      for (int axis = 0; axis < lattice_.axes() && kind_ == PyramidKind::kBest; ++axis)
        if (const int fine = lattice_.halved(coarse, axis); fine >= 0)
          arrive(k, coarse, fine, costs_.cost.differences(coarse, axis), static_cast<int8_t>(axis));
    }
  }

  void arrive(size_t k, int coarse, int fine, double cost, int8_t halved) {
    const double total = best_[k - 1][static_cast<size_t>(coarse)].cost + cost;
    Arrival& best = best_[k][static_cast<size_t>(fine)];
    if (total < best.cost) best = {total, coarse, halved};
  }

  // The isotropic pyramid halves all axes that it can.
  bool allowed(int coarse, int fine) const {
    if (!lattice_.contains(coarse, fine)) return false;
    if (kind_ != PyramidKind::kIsotropic) return true;
    const AxisSizes c = lattice_.cell(coarse), f = lattice_.cell(fine);
    for (size_t a = 0; a < static_cast<size_t>(lattice_.axes()); ++a)
      if (f[a] != std::max(c[a] / 2, 1)) return false;
    return true;
  }

  const CellLattice& lattice_;
  StepCosts& costs_;
  PyramidKind kind_;
  size_t count_;
  std::array<std::vector<Arrival>, kMaxLevels> best_;
};

// Adds what the tables of nodes take: `table_bits` for every node.
void add_tables(const CellLattice& lattice, const FieldShape& shape, double table_bits, Steps& cost) {
  for (int p = 0; p < lattice.count(); ++p) {
    double nodes = 1;
    for (int a = 0; a < lattice.axes(); ++a)
      nodes *= shape.block_size[static_cast<size_t>(a)] / lattice.cell(p)[static_cast<size_t>(a)];
    cost.top(p) += table_bits * nodes;
    for (int coarse = 0; coarse < lattice.count(); ++coarse) cost.residuals(coarse, p) += table_bits * nodes;
    for (int a = 0; a < lattice.axes(); ++a) cost.differences(p, a) += table_bits * nodes;
  }
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

ShapeChoice choose_pyramid(const FieldShape& shape, const FieldTextures& textures, PyramidKind kind, double price,
                           double table_bits, int64_t work) {
  const CellLattice lattice(shape);
  const int block = largest_block(shape);
  const BlockBox box = box_of(shape, block);
  const std::vector<float>& importance = textures.weights_of(block).cell_importance;
  const int log2 = box.samples() > 256 ? 3 : 4;
  const int64_t per_tile = comparisons(lattice, box) * kNodePlanes << (2 * log2);
  const auto tiles =
      choose_tiles(textures, importance, 1 << log2, static_cast<size_t>(std::clamp<int64_t>(work / per_tile, 2, 48)));
  const TileAnalysis analysis(lattice, shape, textures, importance, log2, price);
  std::vector<StepCosts> of_tile(tiles.size(), StepCosts(lattice));
  tbb::parallel_for(size_t{0}, tiles.size(),
                    [&](size_t t) { of_tile[t] = analysis.costs_of(box, tiles[t].first, tiles[t].second); });
  StepCosts costs(lattice);
  for (const StepCosts& own : of_tile) costs.cost.add(own.cost), costs.bits.add(own.bits);
  const double texels = static_cast<double>(textures.width) * textures.height,
               share = static_cast<double>(tiles.size() << (2 * log2)) / texels;
  add_tables(lattice, shape, share * table_bits, costs.cost);
  ShapeChoice choice = PyramidSearch(lattice, costs, kind).choice();
  choice.bits *= shape.block_count() / std::max(share, 1e-9);
  return choice;
}

}  // namespace vitrine
