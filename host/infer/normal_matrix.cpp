// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/normal_matrix.h"

#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <array>
#include <span>

namespace vitrine {
namespace {

constexpr uint32_t kBands = 32;  // at most; what is done side by side
constexpr uint32_t kNone = UINT32_MAX;
constexpr uint32_t kChunkNodes = 4096;                 // allocated at once
constexpr uint32_t kRowSlots = 64, kPairSlots = 1024;  // of the tables below: powers of two

using Value = std::array<float, 16>;  // d^2 / dx_i dx_j at 4 i + j, i in the row's block, j in the column's

// A context of its own: an interruption of the work around this would leave the sums undone without a word.
template <typename Body>
void for_each_number(size_t count, const Body& body) {
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::parallel_for(size_t{0}, count, body, context);
}

}  // namespace

struct NormalMatrix::Entry {  // of a filtered row: the weights of one block's texels
  uint32_t block = 0;
  std::array<float, 4> weight{};
};

namespace {

// Gathers the entries of one filtered row: neighbouring supersamples name the same few blocks over and over.
template <typename Entry>
class RowGatherer {
 public:
  void clear() {
    entries_.clear();
    for (Slot& slot : slots_) slot.block = kNone;
  }
  void add(uint32_t block, uint32_t place, float weight) {
    Slot& slot = slots_[block % kRowSlots];
    if (slot.block != block) slot = {block, find(block)};
    entries_[slot.index].weight[place] += weight;
  }
  std::span<const Entry> sorted() {
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.block < b.block; });
    return entries_;
  }

 private:
  struct Slot {
    uint32_t block = kNone, index = 0;
  };
  uint32_t find(uint32_t block) {
    const auto at = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.block == block; });
    if (at != entries_.end()) return static_cast<uint32_t>(at - entries_.begin());
    entries_.push_back({block, {}});
    return static_cast<uint32_t>(entries_.size() - 1);
  }
  std::vector<Entry> entries_;
  std::array<Slot, kRowSlots> slots_{};
};

}  // namespace

struct NormalMatrix::Rows {
  struct Line {  // one row of pixels
    uint32_t first_block = kNone, last_block = 0;
    std::vector<float> scales;
    std::vector<uint32_t> starts{0};
    std::vector<Entry> entries;  // blocks ascend
  };
  std::vector<Line> lines;
};

// Block rows [first, first + size). While states are added the blocks of a row are a list in ascending columns; afterwards an
// array.
class NormalMatrix::Band {
 public:
  Band(uint32_t first, uint32_t size) : first_(first), heads_(size, kNone) {}

  void add(const Rows::Line& line) {
    if (line.first_block == kNone || line.last_block < first_ || line.first_block >= first_ + heads_.size()) return;
    for (size_t r = 0; r < line.scales.size(); ++r)
      add_row(std::span(line.entries).subspan(line.starts[r], line.starts[r + 1] - line.starts[r]), line.scales[r]);
  }

  void finish() {
    columns_.reserve(node_count_);
    values_.reserve(node_count_);
    for (const uint32_t head : heads_) {
      starts_.push_back(static_cast<uint32_t>(columns_.size()));
      for (uint32_t n = head; n != kNone; n = node(n).next) {
        columns_.push_back(node(n).column);
        values_.push_back(node(n).value);
      }
    }
    starts_.push_back(static_cast<uint32_t>(columns_.size()));
    chunks_.clear();
    chunks_.shrink_to_fit();
    pairs_ = {};
  }

  uint32_t first() const { return first_; }
  uint32_t size() const { return static_cast<uint32_t>(heads_.size()); }
  uint32_t count() const { return node_count_; }
  std::span<const uint32_t> columns(uint32_t row) const {
    return std::span(columns_).subspan(starts_[row], starts_[row + 1] - starts_[row]);
  }
  uint32_t start(uint32_t row) const { return starts_[row]; }
  const Value& value(uint32_t number) const { return values_[number]; }

  // Blocks below the diagonal in this band's rows, as places of their mirror images.
  struct Mirror {
    uint32_t row = 0, number = 0;  // block row; value in the band that holds it
  };
  std::vector<uint32_t> mirror_starts;
  std::vector<Mirror> mirrors;

  size_t bytes() const {
    return chunks_.size() * kChunkNodes * sizeof(Node) + columns_.size() * (sizeof(Value) + sizeof(uint32_t)) +
           mirrors.size() * sizeof(Mirror) + (heads_.size() + starts_.size() + mirror_starts.size()) * sizeof(uint32_t);
  }

 private:
  struct Node {
    uint32_t column = 0, next = kNone;
    Value value{};
  };
  Node& node(uint32_t number) { return chunks_[number / kChunkNodes][number % kChunkNodes]; }

  uint32_t make_node(uint32_t column, uint32_t next) {
    if (node_count_ % kChunkNodes == 0) chunks_.push_back(std::make_unique<Node[]>(kChunkNodes));
    node(node_count_) = {column, next, {}};
    return node_count_++;
  }

  void add_row(std::span<const Entry> entries, float scale) {
    for (size_t i = 0; i < entries.size(); ++i) {
      const uint32_t row = entries[i].block - first_;  // beyond all rows if it is below the first
      if (row < heads_.size()) add_blocks(row, entries[i], entries.subspan(i), scale);
    }
  }

  void add_blocks(uint32_t row, const Entry& own, std::span<const Entry> others, float scale) {
    for (const Entry& other : others) {
      Pair& pair = pairs_[(row * 37 + other.block) % kPairSlots];
      if (pair.row != row || pair.column != other.block) pair = {row, other.block, &value_at(row, other.block)};
      Value& value = *pair.value;
      for (size_t i = 0; i < 4; ++i) {
        const float weight = scale * own.weight[i];
        for (size_t j = 0; j < 4; ++j) value[4 * i + j] += weight * other.weight[j];
      }
    }
  }

  Value& value_at(uint32_t row, uint32_t column) {
    uint32_t previous = kNone, at = heads_[row];
    while (at != kNone && node(at).column < column) previous = at, at = node(at).next;
    if (at == kNone || node(at).column != column) {
      at = make_node(column, at);
      (previous == kNone ? heads_[row] : node(previous).next) = at;
    }
    return node(at).value;
  }

  struct Pair {  // looked up lately: neighbouring pixels name the same ones
    uint32_t row = kNone, column = kNone;
    Value* value = nullptr;
  };
  uint32_t first_, node_count_ = 0;
  std::vector<uint32_t> heads_;
  std::vector<std::unique_ptr<Node[]>> chunks_;
  std::vector<Pair> pairs_ = std::vector<Pair>(kPairSlots);
  std::vector<uint32_t> starts_, columns_;
  std::vector<Value> values_;
};

NormalMatrix::NormalMatrix(const Pyramid& pyramid) : block_of_texel_(pyramid.size()) {
  for (const Pyramid::Level& level : pyramid.levels()) {
    const int columns = (level.width + 1) / 2, rows = (level.height + 1) / 2;
    const auto first = static_cast<uint32_t>(places_.size());
    const auto texel = [&](int x, int y) {
      return static_cast<uint32_t>(level.offset) +
             static_cast<uint32_t>(std::min(y, level.height - 1) * level.width + std::min(x, level.width - 1));
    };
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x)
        places_.push_back({{texel(2 * x, 2 * y), texel(2 * x + 1, 2 * y), texel(2 * x, 2 * y + 1), texel(2 * x + 1, 2 * y + 1)}});
    for (int y = 0; y < level.height; ++y)
      for (int x = 0; x < level.width; ++x)
        block_of_texel_[texel(x, y)] =
            4 * (first + static_cast<uint32_t>(y / 2 * columns + x / 2)) + static_cast<uint32_t>(y % 2 * 2 + x % 2);
  }
  const auto blocks = static_cast<uint32_t>(places_.size());
  band_blocks_ = (blocks + kBands - 1) / kBands;
  for (uint32_t first = 0; first < blocks; first += band_blocks_)
    bands_.push_back(std::make_unique<Band>(first, std::min(band_blocks_, blocks - first)));
}

NormalMatrix::~NormalMatrix() = default;

NormalMatrix::Rows NormalMatrix::filtered_rows(const Observation& observation) const {
  const PixelWindow& window = observation.matrix->window();
  Rows rows;
  rows.lines.resize(static_cast<size_t>(window.height));
  for_each_number(rows.lines.size(), [&](size_t y) {
    Rows::Line& line = rows.lines[y];
    RowGatherer<Entry> gatherer;
    for (int x = 0; x < window.width; ++x) {
      const float scale = observation.scale[y * static_cast<size_t>(window.width) + static_cast<size_t>(x)];
      if (!(scale > 0)) continue;
      gatherer.clear();
      observation.matrix->visit_row(x, static_cast<int>(y), [&](uint32_t texel, float weight) {
        const uint32_t block = block_of_texel_[texel];
        gatherer.add(block / 4, block % 4, weight);
      });
      const std::span<const Entry> row = gatherer.sorted();
      line.first_block = std::min(line.first_block, row.front().block);
      line.last_block = std::max(line.last_block, row.back().block);
      line.scales.push_back(scale);
      line.entries.insert(line.entries.end(), row.begin(), row.end());
      line.starts.push_back(static_cast<uint32_t>(line.entries.size()));
    }
  });
  return rows;
}

void NormalMatrix::add(const Observation& observation) {
  const Rows rows = filtered_rows(observation);
  for_each_number(bands_.size(), [&](size_t b) {
    for (const Rows::Line& line : rows.lines) bands_[b]->add(line);
  });
}

void NormalMatrix::finish() {
  for_each_number(bands_.size(), [&](size_t b) { bands_[b]->finish(); });
  index_transposed();
}

void NormalMatrix::index_transposed() {
  const auto for_each_mirror = [&](const auto& body) {
    for (const auto& band : bands_)
      for (uint32_t row = 0; row < band->size(); ++row) {
        uint32_t number = band->start(row);
        for (const uint32_t column : band->columns(row)) {
          if (column != band->first() + row)
            body(*bands_[column / band_blocks_], column % band_blocks_, Band::Mirror{band->first() + row, number});
          ++number;
        }
      }
  };
  for (const auto& band : bands_) band->mirror_starts.assign(band->size() + 1, 0);
  for_each_mirror([](Band& band, uint32_t row, const Band::Mirror&) { ++band.mirror_starts[row + 1]; });
  for (const auto& band : bands_) {
    for (uint32_t row = 0; row < band->size(); ++row) band->mirror_starts[row + 1] += band->mirror_starts[row];
    band->mirrors.resize(band->mirror_starts.back());
  }
  std::vector<std::vector<uint32_t>> filled;
  for (const auto& band : bands_) filled.push_back(band->mirror_starts);
  for_each_mirror([&](Band& band, uint32_t row, const Band::Mirror& mirror) {
    band.mirrors[filled[band.first() / band_blocks_][row]++] = mirror;
  });
}

size_t NormalMatrix::block_count() const {
  size_t count = 0;
  for (const auto& band : bands_) count += band->count();
  return count;
}

size_t NormalMatrix::bytes() const {
  size_t bytes = block_of_texel_.size() * sizeof(uint32_t) + places_.size() * sizeof(Place);
  for (const auto& band : bands_) bytes += band->bytes();
  return bytes;
}

template <typename T>
void NormalMatrix::add_product_of(const T* texels, T* sum) const {
  for_each_number(bands_.size(), [&](size_t b) {
    const Band& band = *bands_[b];
    for (uint32_t row = 0; row < band.size(); ++row) {
      T own[4] = {};
      uint32_t number = band.start(row);
      for (const uint32_t column : band.columns(row)) {
        const Value& value = band.value(number++);
        for (size_t j = 0; j < 4; ++j) {
          const T x = texels[places_[column].texel[j]];
          for (size_t i = 0; i < 4; ++i) own[i] += value[4 * i + j] * x;
        }
      }
      for (uint32_t m = band.mirror_starts[row]; m < band.mirror_starts[row + 1]; ++m) {
        const Band::Mirror& mirror = band.mirrors[m];
        const Value& value = bands_[mirror.row / band_blocks_]->value(mirror.number);
        for (size_t j = 0; j < 4; ++j) {
          const T x = texels[places_[mirror.row].texel[j]];
          for (size_t i = 0; i < 4; ++i) own[i] += value[4 * j + i] * x;
        }
      }
      for (size_t i = 0; i < 4; ++i) sum[places_[band.first() + row].texel[i]] += own[i];
    }
  });
}

template void NormalMatrix::add_product_of<Lanes<1>>(const Lanes<1>*, Lanes<1>*) const;
template void NormalMatrix::add_product_of<Lanes<2>>(const Lanes<2>*, Lanes<2>*) const;
template void NormalMatrix::add_product_of<Lanes<3>>(const Lanes<3>*, Lanes<3>*) const;

}  // namespace vitrine
