// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/encode/zerotree_search.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "host/encode/bit_costs.h"
#include "host/encode/forward_wavelet.h"

namespace vitrine {
namespace {

constexpr int kLargest = (1 << kMaxBitPlanes) - 1;

int top_bit(int magnitude) { return std::bit_width(static_cast<unsigned>(magnitude)) - 1; }

// Importance of every cell of every level: the mean over what it covers.
std::vector<float> importance_of(const NodeTask& task, const SpihtLayout& layout) {
  std::vector<float> out(layout.map_cells, 1.0f);
  if (task.cell_weights.empty()) return out;
  const int columns = (task.width + kCellSize - 1) / kCellSize, rows = (task.height + kCellSize - 1) / kCellSize;
  for (int k = 1; k <= layout.levels; ++k) {
    for (int y = 0; y < layout.height[static_cast<size_t>(k)]; ++y)
      for (int x = 0; x < layout.width[static_cast<size_t>(k)]; ++x) {
        const int left = (x << k) / kCellSize, top = (y << k) / kCellSize;
        const int right = std::min(columns, (((x + 1) << k) + kCellSize - 1) / kCellSize);
        const int bottom = std::min(rows, (((y + 1) << k) + kCellSize - 1) / kCellSize);
        float sum = 0;
        for (int v = top; v < bottom; ++v)
          for (int u = left; u < right; ++u) sum += task.cell_weights[static_cast<size_t>(v * columns + u)];
        out[layout.cell(k, x, y)] = sum / static_cast<float>((right - left) * (bottom - top));
      }
  }
  return out;
}

// What a tree costs, in bits of distortion and code.
struct TreeCost {
  float kept = 0;    // as decided, but for the symbols by which its parent says that there is something
  float zeroed = 0;  // if nothing of it is coded
};

class PlaneSearch {
 public:
  // `earlier`: the planes that are coded before this one.
  PlaneSearch(const NodeTask& task, const SpihtLayout& layout, const SpihtBitCosts& costs, const std::vector<float>& importance,
              int plane, std::span<const ZerotreePlane> earlier)
      : task_(task), layout_(layout), costs_(costs), importance_(importance), plane_(plane), earlier_(earlier) {
    const size_t texels = layout.texels();
    coefficients_ = forward_wavelet(layout, task.planes.subspan(static_cast<size_t>(plane) * texels, texels));
    out_.value.assign(texels, 0);
    out_.set_top.assign(layout.map_cells, -1);
    out_.descendants_top.assign(layout.map_cells, -1);
    for (auto& m : magnitude_) m.assign(layout.map_cells, 0);
  }

  ZerotreePlane run() {
    const int roots = layout_.levels;
    for (int k = 1; k <= roots; ++k) round_level(k);
    const int highest = std::max(rounded_low_top(), root_top());
    if (roots > 0) for_each_cell(roots, [&](int x, int y) { decide_root(x, y, highest); });
    out_.bit_planes = std::max(decide_low(highest), root_top()) + 1;
    return std::move(out_);
  }

 private:
  struct Band {
    float inverse_step = 0;  // steps per unit of a coefficient
    float error = 0;         // bits that a squared error of one step is worth at importance 1
  };

  template <typename Visit>
  void for_each_cell(int level, const Visit& visit) const {
    for (int y = 0; y < layout_.height[static_cast<size_t>(level)]; ++y)
      for (int x = 0; x < layout_.width[static_cast<size_t>(level)]; ++x) visit(x, y);
  }
  template <typename Visit>
  void for_each_child(int level, int x, int y, const Visit& visit) const {
    if (level < 2) return;
    const size_t below = static_cast<size_t>(level) - 1;
    for (int v = 2 * y; v < std::min(2 * y + 2, layout_.height[below]); ++v)
      for (int u = 2 * x; u < std::min(2 * x + 2, layout_.width[below]); ++u) visit(u, v);
  }

  Band band(int level, int orientation) const {
    const uint16_t step = task_.steps[static_cast<size_t>(plane_)];
    const double in_codes = band_step(layout_, level, orientation, step) / static_cast<double>(kStepUnitsPerCode);
    const double norm = 65536.0 / band_scale(layout_, level, orientation);
    return {static_cast<float>(1 / (in_codes * (1 << kWaveletFraction))),
            static_cast<float>(task_.weights[static_cast<size_t>(plane_)] * in_codes * in_codes * norm * norm)};
  }

  // Magnitudes to the nearest, and the tops that follow, from fine levels to coarse.
  void round_level(int level) {
    for (size_t o = 0; o < kOrientations; ++o) bands_[static_cast<size_t>(level)][o] = band(level, static_cast<int>(o));
    for_each_cell(level, [&](int x, int y) {
      const size_t at = layout_.cell(level, x, y);
      int top = -1;
      for_each_child(level, x, y, [&](int u, int v) { top = std::max(top, int{out_.set_top[layout_.cell(level - 1, u, v)]}); });
      out_.descendants_top[at] = static_cast<int8_t>(top);
      for (int o = 0; o < kOrientations; ++o) {
        if (!layout_.has(level, x, y, o)) continue;
        const int m = std::min(static_cast<int>(steps_at(level, x, y, o) + 0.5f), kLargest);
        magnitude_[static_cast<size_t>(o)][at] = static_cast<int16_t>(m);
        top = std::max(top, top_bit(m));
      }
      out_.set_top[at] = static_cast<int8_t>(top);
    });
  }

  float steps_at(int level, int x, int y, int o) const {
    return std::fabs(static_cast<float>(coefficients_[layout_.coefficient(level, x, y, o)])) *
           bands_[static_cast<size_t>(level)][static_cast<size_t>(o)].inverse_step;
  }

  float low_steps(size_t at, const Band& low) const {
    return std::fabs(static_cast<float>(coefficients_[at])) * low.inverse_step;
  }

  // Highest bit plane of the trees, and of the low band to the nearest.
  int root_top() const {
    int top = -1;
    if (layout_.levels == 0) return top;
    for_each_cell(layout_.levels,
                  [&](int x, int y) { top = std::max(top, int{out_.set_top[layout_.cell(layout_.levels, x, y)]}); });
    return top;
  }
  int rounded_low_top() const {
    const Band low = band(layout_.levels, -1);
    int top = -1;
    for_each_cell(layout_.levels, [&](int x, int y) {
      top = std::max(top, top_bit(std::min(static_cast<int>(low_steps(low_place(x, y), low) + 0.5f), kLargest)));
    });
    return top;
  }
  size_t low_place(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(layout_.width[0]) + static_cast<size_t>(x);
  }

  // Row by row, each against what was decided to the left of it and above. Returns the highest bit plane.
  int decide_low(int from) {
    const Band low = band(layout_.levels, -1);
    int top = -1;
    for_each_cell(layout_.levels, [&](int x, int y) {
      const size_t at = low_place(x, y), width = static_cast<size_t>(layout_.width[0]);
      const int left = x > 0 ? std::abs(out_.value[at - 1]) : 0, above = y > 0 ? std::abs(out_.value[at - width]) : 0;
      const float importance = layout_.levels > 0 ? importance_[layout_.cell(layout_.levels, x, y)] : 1;
      const int m = best_low(low_steps(at, low), low.error * importance, from, left, above);
      out_.value[at] = static_cast<int16_t>(coefficients_[at] < 0 ? -m : m);
      top = std::max(top, top_bit(m));
    });
    return top;
  }

  int best_low(float u, float weight, int from, int left, int above) const {
    const int nearest = std::min(static_cast<int>(u + 0.5f), kLargest);
    float best = INFINITY;
    int chosen = 0;
    for (const int m : {nearest, nearest - 1, 0}) {
      if (m < 0) continue;
      const float e = u - static_cast<float>(m), cost = weight * e * e + low_bits(m, from, left, above);
      if (cost < best) best = cost, chosen = m;
    }
    return chosen;
  }

  float low_bits(int m, int from, int left, int above) const {
    const int top = top_bit(m);
    float bits = m > 0 ? 1 : 0;
    for (int n = from; n >= std::max(top, 0); --n) {
      const int context = kSpihtContextLow + 3 * (plane_ > 0) + ((left >> n) != 0) + ((above >> n) != 0);
      bits += costs_[static_cast<size_t>(context)][n == top];
    }
    return m > 0 ? bits + refinement_bits(m) : bits;
  }

  float refinement_bits(int m) const {
    float bits = 0;
    const int top = top_bit(m);
    for (int n = top - 1; n >= 0; --n) {
      const int context = kSpihtContextRefine + 3 * (plane_ > 0) + (n == top - 1 ? 1 : 2);
      bits += costs_[static_cast<size_t>(context)][(m >> n) & 1];
    }
    return bits;
  }

  void decide_root(int x, int y, int highest) {
    const TreeCost cost = decide(layout_.levels, x, y);
    const size_t at = layout_.cell(layout_.levels, x, y);
    const float kept = cost.kept + flag_bits(set_context(layout_.levels, at), out_.set_top, at, highest, out_.set_top[at], false);
    const float zeroed = cost.zeroed + flag_bits(set_context(layout_.levels, at), out_.set_top, at, highest, -1, false);
    if (out_.set_top[at] < 0 || zeroed < kept)
      zero(layout_.levels, x, y);
    else
      store(layout_.levels, x, y);
  }

  int set_context(int level, size_t at) const {
    return kSpihtContextSet + 6 * (plane_ == 0 ? std::min(level, 3) - 1 : 3 + earlier_set(at));
  }
  bool earlier_set(size_t at) const {
    for (const ZerotreePlane& before : earlier_)
      if (before.set_top[at] >= 0) return true;
    return false;
  }

  // Bits of a flag that is asked from plane `from` down, and is set at plane `top` (-1: never). The first time may be as part
  // of what just became significant.
  float flag_bits(int context, const std::vector<int8_t>& tops, size_t at, int from, int top, bool born) const {
    const size_t stride = stride_;
    float bits = 0;
    for (int n = from; n >= std::max(top, 0); --n) {
      const int near = (tops[at - 1] >= n) + (tops[at + 1] > n) + (tops[at - stride] >= n) + (tops[at + stride] > n);
      bits += costs_[static_cast<size_t>(context + 3 * (born && n == from) + std::min(near, 2))][n == top];
    }
    return bits;
  }

  TreeCost decide(int level, int x, int y) {
    const size_t at = layout_.cell(level, x, y);
    TreeCost below = decide_children(level, x, y);
    stride_ = layout_.stride(level);
    int top = out_.descendants_top[at];
    for (int o = 0; o < kOrientations; ++o) top = std::max(top, top_bit(magnitude_[static_cast<size_t>(o)][at]));
    TreeCost total = below;
    if (top < 0) {
      for (int o = 0; o < kOrientations; ++o)
        if (layout_.has(level, x, y, o)) total.zeroed += zero_error(level, x, y, o);
      total.kept = total.zeroed;
      out_.set_top[at] = -1;
      return total;
    }
    bool own = false;
    const int asked = top;
    top = out_.descendants_top[at];
    for (int o = 0; o < kOrientations; ++o) {
      if (!layout_.has(level, x, y, o)) continue;
      total.zeroed += zero_error(level, x, y, o);
      total.kept += decide_coefficient(level, x, y, o, asked);
      const int m = magnitude_[static_cast<size_t>(o)][at];
      own |= m > 0;
      top = std::max(top, top_bit(m));
    }
    if (level > 1) {
      const int context = kSpihtContextDescendants + 12 * (plane_ > 0) + 6 * own;
      total.kept += flag_bits(context, out_.descendants_top, at, asked, out_.descendants_top[at], true);
    }
    out_.set_top[at] = static_cast<int8_t>(top);
    return total;
  }

  // Children that are not worth their bits become zero; so do all where none is left.
  TreeCost decide_children(int level, int x, int y) {
    TreeCost total;
    if (level < 2) return total;
    const size_t at = layout_.cell(level, x, y);
    const int asked = out_.descendants_top[at];
    int top = -1;
    for_each_child(level, x, y, [&](int u, int v) {
      const TreeCost cost = decide(level - 1, u, v);
      const size_t child = layout_.cell(level - 1, u, v);
      stride_ = layout_.stride(level - 1);
      const int context = set_context(level - 1, child);
      const float kept = cost.kept + flag_bits(context, out_.set_top, child, asked, out_.set_top[child], true);
      const float zeroed = cost.zeroed + flag_bits(context, out_.set_top, child, asked, -1, true);
      total.zeroed += cost.zeroed;
      if (out_.set_top[child] < 0 || zeroed <= kept) {
        zero(level - 1, u, v);
        total.kept += zeroed;
      } else {
        top = std::max(top, int{out_.set_top[child]});
        total.kept += kept;
      }
    });
    // Whether there is anything below costs a flag either way; the exact one is the cell's.
    if (top < 0 || total.zeroed < total.kept) {
      for_each_child(level, x, y, [&](int u, int v) { zero(level - 1, u, v); });
      top = -1;
      total.kept = total.zeroed;
    }
    out_.descendants_top[at] = static_cast<int8_t>(top);
    return total;
  }

  float error_weight(int level, size_t at, int o) const {
    return bands_[static_cast<size_t>(level)][static_cast<size_t>(o)].error * importance_[at];
  }
  float zero_error(int level, int x, int y, int o) const {
    const float u = steps_at(level, x, y, o);
    return error_weight(level, layout_.cell(level, x, y), o) * u * u;
  }

  float decide_coefficient(int level, int x, int y, int o, int from) {
    const size_t at = layout_.cell(level, x, y);
    const float u = steps_at(level, x, y, o), weight = error_weight(level, at, o);
    int16_t& magnitude = magnitude_[static_cast<size_t>(o)][at];
    const int nearest = magnitude;
    const std::array<int, 3> candidates = {nearest, nearest - 1, 0};
    float best = INFINITY;
    for (const int m : candidates) {
      if (m < 0 || (m == 0 && best < INFINITY && magnitude == 0)) continue;
      const float e = u - static_cast<float>(m);
      const float cost = weight * e * e + magnitude_bits(level, x, y, o, m, from);
      if (cost < best) best = cost, magnitude = static_cast<int16_t>(m);
    }
    return best;
  }

  float magnitude_bits(int level, int x, int y, int o, int m, int from) const {
    const size_t at = layout_.cell(level, x, y);
    const int top = top_bit(m);
    float bits = 0;
    for (int n = from; n >= std::max(top, 0); --n)
      bits += costs_[significance_context(level, x, y, at, o, n, n == from)][n == top];
    if (m == 0) return bits;
    return bits + 1 + refinement_bits(m);
  }

  size_t significance_context(int level, int x, int y, size_t at, int o, int n, bool born) const {
    const std::vector<int16_t>& m = magnitude_[static_cast<size_t>(o)];
    const size_t stride = layout_.stride(level);
    const auto before = [&](size_t cell) { return (m[cell] >> n) != 0; };
    const auto after = [&](size_t cell) { return (m[cell] >> (n + 1)) != 0; };
    const int near = 2 * (before(at - 1) + after(at + 1) + before(at - stride) + after(at + stride)) + before(at - stride - 1) +
                     before(at - stride + 1) + after(at + stride - 1) + after(at + stride + 1);
    const bool parent = level < layout_.levels && before_parent(level, x, y, o, n);
    const int kind = plane_ == 0 ? o == kDiagonalDetail : 2 + earlier_coefficient(level, x, y, o);
    return static_cast<size_t>(kSpihtContextSignificant + 20 * kind + 10 * born + 5 * parent +
                               neighbour_class(static_cast<uint32_t>(near)));
  }
  bool before_parent(int level, int x, int y, int o, int n) const {
    return (magnitude_[static_cast<size_t>(o)][layout_.cell(level + 1, x >> 1, y >> 1)] >> n) != 0;
  }
  bool earlier_coefficient(int level, int x, int y, int o) const {
    const size_t place = layout_.coefficient(level, x, y, o);
    for (const ZerotreePlane& before : earlier_)
      if (before.value[place] != 0) return true;
    return false;
  }

  void zero(int level, int x, int y) {
    const size_t at = layout_.cell(level, x, y);
    if (out_.set_top[at] < 0 && out_.descendants_top[at] < 0) {
      bool any = false;
      for (const auto& m : magnitude_) any |= m[at] != 0;
      if (!any) return;
    }
    for (auto& m : magnitude_) m[at] = 0;
    out_.set_top[at] = out_.descendants_top[at] = -1;
    for_each_child(level, x, y, [&](int u, int v) { zero(level - 1, u, v); });
  }

  void store(int level, int x, int y) {
    const size_t at = layout_.cell(level, x, y);
    if (out_.set_top[at] < 0) return;
    for (int o = 0; o < kOrientations; ++o) {
      if (!layout_.has(level, x, y, o)) continue;
      const size_t place = layout_.coefficient(level, x, y, o);
      const int m = magnitude_[static_cast<size_t>(o)][at];
      out_.value[place] = static_cast<int16_t>(coefficients_[place] < 0 ? -m : m);
    }
    for_each_child(level, x, y, [&](int u, int v) { store(level - 1, u, v); });
  }

  const NodeTask& task_;
  const SpihtLayout& layout_;
  const SpihtBitCosts& costs_;
  const std::vector<float>& importance_;
  int plane_;
  std::span<const ZerotreePlane> earlier_;
  std::vector<int16_t> coefficients_;
  std::array<std::array<Band, kOrientations>, kMaxWaveletLevels + 1> bands_{};
  std::array<std::vector<int16_t>, kOrientations> magnitude_;  // per cell
  size_t stride_ = 0;
  ZerotreePlane out_;
};

}  // namespace

SpihtBitCosts spiht_bit_costs(const SpihtContextSet& contexts) {
  SpihtBitCosts costs;
  for (size_t c = 0; c < kSpihtContextCount; ++c) {
    const uint32_t p = contexts[c].probability_of_one();
    costs[c] = {bits_of_probability(32768 - p), bits_of_probability(p)};
  }
  return costs;
}

std::array<ZerotreePlane, kNodePlanes> search_zerotrees(const NodeTask& task, const SpihtLayout& layout,
                                                        const SpihtBitCosts& costs) {
  std::array<ZerotreePlane, kNodePlanes> planes;
  const std::vector<float> importance = importance_of(task, layout);
  for (size_t p = 0; p < kNodePlanes; ++p)
    planes[p] = PlaneSearch(task, layout, costs, importance, static_cast<int>(p), std::span(planes).first(p)).run();
  return planes;
}

}  // namespace vitrine
