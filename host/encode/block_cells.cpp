// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/block_cells.h"

#include <algorithm>
#include <cmath>

namespace vitrine {
namespace {

// Deals a cell's weight out to its leaves.
class ShareDealer {
 public:
  ShareDealer(const FieldShape& shape, const std::vector<GridIndex>& samples, BlockCell& cell)
      : shape_(shape), samples_(samples), cell_(cell) {}

  void deal(int level) {
    std::vector<size_t> all(cell_.leaves.size());
    for (size_t i = 0; i < all.size(); ++i) all[i] = i;
    if (!shape_.pyramid.has_differences(level)) return deal_mean(all, level + 1, 1);
    const auto [kept, subtracted] = halves(all, level);
    if (kept.empty() || subtracted.empty()) return;
    deal_mean(kept, level + 1, 0.5);
    deal_mean(subtracted, level + 1, -0.5);
  }

 private:
  struct Halves {
    std::vector<size_t> kept, subtracted;
  };
  Halves halves(const std::vector<size_t>& members, int level) const {
    Halves both;
    for (const size_t i : members)
      (shape_.subtracts(samples_[cell_.leaves[i]], level) ? both.subtracted : both.kept).push_back(i);
    return both;
  }

  // `level`: the one that comes next.
  void deal_mean(const std::vector<size_t>& members, int level, double weight) {
    if (level >= shape_.pyramid.level_count || !shape_.pyramid.has_differences(level)) {
      const double share = weight / static_cast<double>(members.size());
      for (const size_t i : members) cell_.shares[i] = static_cast<int32_t>(std::lround(std::ldexp(share, kShareLog2)));
      return;
    }
    const auto [kept, subtracted] = halves(members, level);
    const bool both = !kept.empty() && !subtracted.empty();
    if (!kept.empty()) deal_mean(kept, level + 1, both ? weight / 2 : weight);
    if (!subtracted.empty()) deal_mean(subtracted, level + 1, both ? weight / 2 : weight);
  }

  const FieldShape& shape_;
  const std::vector<GridIndex>& samples_;
  BlockCell& cell_;
};

}  // namespace

std::vector<GridIndex> samples_of_block(const FieldShape& shape, int block) {
  GridIndex first{}, last{};
  for (int a = shape.space.axis_count - 1; a >= 0; --a) {
    const size_t i = static_cast<size_t>(a);
    const int size = shape.block_size[i], blocks = shape.blocks_along(a), start = block % blocks * size - shape.stagger[i];
    first[i] = std::max(start, 0);
    last[i] = std::min(start + size, shape.space.axes[i].samples) - 1;
    if (last[i] < first[i]) return {};
    block /= blocks;
  }
  std::vector<GridIndex> samples;
  GridIndex at = first;
  for (;;) {
    samples.push_back(at);
    int a = shape.space.axis_count - 1;
    while (a >= 0 && at[static_cast<size_t>(a)] == last[static_cast<size_t>(a)]) {
      at[static_cast<size_t>(a)] = first[static_cast<size_t>(a)];
      --a;
    }
    if (a < 0) return samples;
    ++at[static_cast<size_t>(a)];
  }
}

std::vector<BlockCell> cells_of_level(const FieldShape& shape, int block, int level) {
  const std::vector<GridIndex> samples = samples_of_block(shape, block);
  std::vector<BlockCell> cells;
  std::vector<int> cell_of_node(static_cast<size_t>(shape.nodes_per_block()), -1);
  for (size_t place = 0; place < samples.size(); ++place) {
    const int node = shape.node_of(samples[place], level) - block * shape.nodes_per_block();
    int& index = cell_of_node[static_cast<size_t>(node)];
    if (index < 0) {
      index = static_cast<int>(cells.size());
      cells.push_back({node, {}, {}, {}});
    }
    BlockCell& cell = cells[static_cast<size_t>(index)];
    cell.leaves.push_back(place);
    cell.subtracted.push_back(shape.subtracts(samples[place], level));
  }
  std::sort(cells.begin(), cells.end(), [](const BlockCell& a, const BlockCell& b) { return a.node < b.node; });
  for (BlockCell& cell : cells) {
    cell.shares.assign(cell.leaves.size(), 0);
    ShareDealer(shape, samples, cell).deal(level);
  }
  if (shape.pyramid.has_differences(level)) std::erase_if(cells, [](const BlockCell& cell) { return cell.shares[0] == 0; });
  return cells;
}

}  // namespace vitrine
