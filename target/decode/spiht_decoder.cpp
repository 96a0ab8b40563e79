// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/decode/spiht_decoder.h"

#include <algorithm>
#include <cstring>

#include "formats/wavelet.h"
#include "target/decode/wavelet_kernels.h"

namespace vitrine {

// The reader that formats/spiht_syntax.h goes through: counts every symbol.
struct SpihtSymbols {
  explicit SpihtSymbols(SpihtDecoder& of) : decoder(of), range(of.range_) {}
  ~SpihtSymbols() {
    decoder.range_ = range;
    decoder.spent_ += symbols * kSpihtUnitsPerSymbol;
  }
  SpihtSymbols(const SpihtSymbols&) = delete;
  SpihtSymbols& operator=(const SpihtSymbols&) = delete;

  bool bit(int context, bool) {
    ++symbols;
    return range.bit(decoder.contexts_[static_cast<size_t>(context)]);
  }
  bool raw(bool) {
    ++symbols;
    return range.raw();
  }
  bool ended() const { return range.ended(); }
  static int bit_planes(int) { return 0; }
  static int set_top(int, size_t) { return 0; }
  static int descendants_top(int, size_t) { return 0; }
  static int value(int, size_t) { return 0; }

  SpihtDecoder& decoder;
  EmbeddedRangeDecoder range;
  uint64_t symbols = 0;
};

namespace {

// Rows that an odd row lags behind the even ones that it is predicted from.
constexpr int kLag = 2;

// Whether four cells in a row have no significant coefficient.
bool none_of_four(const uint16_t* cells) {
  uint64_t four;
  std::memcpy(&four, cells, sizeof(four));
  return (four & (0x0001000100010001u * uint64_t{kCellCoefficients})) == 0;
}

int16_t dequantize_coded(int16_t coded, uint32_t step) {
  const uint32_t bits = static_cast<uint16_t>(coded);
  return dequantize(bits & 0x7fff, (bits & 0x8000) != 0, step);
}

}  // namespace

Status SpihtDecoder::start(const NodeDesc& desc, std::span<const std::byte> bytes, std::span<int16_t> planes,
                           std::span<uint16_t> scratch) {
  phase_ = Phase::kDone;
  if (desc.width < 1 || desc.height < 1 || desc.width > kMaxNodeSize || desc.height > kMaxNodeSize) {
    return {StatusCode::kMalformed, "node size out of range"};
  }
  layout_ = spiht_layout(desc.width, desc.height);
  if (planes.size() < kNodePlanes * layout_.texels()) return {StatusCode::kOutOfMemory, "planes too small for the node"};
  const size_t map_words = kNodePlanes * layout_.map_cells;
  if (scratch.size() < map_words + layout_.texels()) return {StatusCode::kOutOfMemory, "scratch too small for the node"};
  for (const uint16_t s : desc.steps) {
    if (s == 0) return {StatusCode::kMalformed, "quantizer step of zero"};
  }
  if (!load_spiht_contexts(desc.contexts, contexts_)) return {StatusCode::kMalformed, "wrong number of initial context states"};
  std::copy_n(desc.steps, kNodePlanes, steps_.begin());
  range_.start(bytes);
  maps_ = scratch.first(map_words);
  lines_ = {reinterpret_cast<int16_t*>(scratch.data() + map_words), layout_.texels()};
  state_ = {};
  for (size_t p = 0; p < kNodePlanes; ++p) {
    state_.map[p] = maps_.data() + p * layout_.map_cells;
    state_.value[p] = planes.data() + p * layout_.texels();
  }
  row_ = 0;
  spent_ = 0;
  declared_ = desc.units;
  empty_ = bytes.empty();
  phase_ = Phase::kClear;
  return {};
}

Result<uint64_t> SpihtDecoder::step(uint64_t units) {
  const uint64_t before = spent_;
  while (!done() && (spent_ == before || spent_ - before < units)) {
    advance();
    if (declared_ != 0 && (spent_ > declared_ || (done() && spent_ != declared_))) {
      phase_ = Phase::kDone;
      std::fill_n(state_.value[0], kNodePlanes * layout_.texels(), int16_t{0});  // what is neutral in a sum
      return Status{StatusCode::kMalformed, "node takes other units than it declares"};
    }
  }
  return spent_ - before;
}

void SpihtDecoder::advance() {
  switch (phase_) {
    case Phase::kClear:
      return clear_row();
    case Phase::kPlaneCounts:
      return read_plane_counts();
    case Phase::kRoots:
      return read_root();
    case Phase::kColumns:
      return column_row();
    case Phase::kRows:
      return texel_row();
    case Phase::kDone:
      return;
  }
}

void SpihtDecoder::clear_row() {
  const size_t width = static_cast<size_t>(layout_.width[0]), row = static_cast<size_t>(row_);
  for (int16_t* plane : state_.value) std::memset(plane + row * width, 0, sizeof(int16_t) * width);
  const size_t from = maps_.size() * row / static_cast<size_t>(layout_.height[0]);
  const size_t to = maps_.size() * (row + 1) / static_cast<size_t>(layout_.height[0]);
  if (!empty_ && to > from) std::memset(&maps_[from], 0, sizeof(uint16_t) * (to - from));
  spent_ += spiht_units_of_clearing(layout_.width[0]);
  if (++row_ == layout_.height[0]) phase_ = empty_ ? Phase::kDone : Phase::kPlaneCounts;
}

void SpihtDecoder::read_plane_counts() {
  {
    SpihtSymbols symbols(*this);
    SpihtWalk walk(layout_, state_, symbols);
    for (int p = 0; p < kNodePlanes; ++p) bit_planes_[static_cast<size_t>(p)] = walk.code_bit_planes(p);
  }
  bit_ = *std::max_element(bit_planes_.begin(), bit_planes_.end());
  plane_ = kNodePlanes;
  next_bit_plane();
}

// To the next plane that has a bit, of lower significance when all are through.
void SpihtDecoder::next_bit_plane() {
  x_ = y_ = 0;
  phase_ = Phase::kRoots;
  for (;;) {
    if (++plane_ >= kNodePlanes) {
      plane_ = 0;
      if (--bit_ < 0) return begin_plane(0);
    }
    if (bit_planes_[static_cast<size_t>(plane_)] > bit_) return;
  }
}

void SpihtDecoder::read_root() {
  {
    SpihtSymbols symbols(*this);
    SpihtWalk walk(layout_, state_, symbols);
    walk.code_root(plane_, bit_, x_, y_);
  }
  if (range_.ended()) return begin_plane(0);
  const size_t top = static_cast<size_t>(layout_.levels);
  if (++x_ < layout_.width[top]) return;
  x_ = 0;
  if (++y_ == layout_.height[top]) next_bit_plane();
}

// Planes without bit planes are zero as they are.
void SpihtDecoder::begin_plane(int plane) {
  plane_ = plane;
  while (plane_ < kNodePlanes && bit_planes_[static_cast<size_t>(plane_)] == 0) ++plane_;
  if (plane_ == kNodePlanes) return static_cast<void>(phase_ = Phase::kDone);
  level_ = layout_.levels;
  row_ = 0;
  for (int y = 0; y < layout_.height[static_cast<size_t>(level_)]; ++y) dequantize_low_row(y);
  phase_ = level_ > 0 ? Phase::kColumns : Phase::kRows;
}

void SpihtDecoder::dequantize_low_row(int row) {
  const uint32_t step = band_step(layout_, level_, -1, steps_[static_cast<size_t>(plane_)]);
  int16_t* values = plane_row(row);
  for (int x = 0; x < layout_.width[static_cast<size_t>(level_)]; ++x) values[x] = dequantize_coded(values[x], step);
}

void SpihtDecoder::dequantize_cells(int row) {
  const size_t k = static_cast<size_t>(level_), plane = static_cast<size_t>(plane_);
  if (row >= layout_.height[k] || !detailed()) return;
  const uint16_t* cells = state_.map[plane] + layout_.cell(level_, 0, row);
  for (int x = 0; x < layout_.width[k]; ++x) {
    if (x % 4 == 0 && x + 4 <= layout_.width[k] && none_of_four(cells + x)) {
      x += 3;
      continue;
    }
    for (int o = 0; o < kOrientations; ++o) {
      if (!((cells[x] >> (4 * o)) & 1)) continue;
      int16_t& value = plane_row(0)[layout_.coefficient(level_, x, row, o)];
      value = dequantize_coded(value, band_step(layout_, level_, o, steps_[plane]));
    }
  }
}

const int16_t* SpihtDecoder::source_row(int i) const {
  const int height = layout_.height[static_cast<size_t>(level_) - 1], row = band_place(mirrored(i, height), height);
  return state_.value[static_cast<size_t>(plane_)] + static_cast<size_t>(row) * static_cast<size_t>(layout_.width[0]);
}

void SpihtDecoder::even_row(int i) {
  const int height = layout_.height[static_cast<size_t>(level_) - 1];
  const int16_t* low = source_row(2 * i);
  int16_t* out = line(2 * i);
  if (height == 1 || !detailed()) return static_cast<void>(std::copy_n(low, columns(), out));
  const int16_t *a = source_row(2 * i - 1), *b = source_row(2 * i + 1), *c = source_row(2 * i - 3), *d = source_row(2 * i + 3);
  invert_update_row(low, {a, b, c, d}, columns(), out);
}

void SpihtDecoder::odd_row(int i) {
  const int height = layout_.height[static_cast<size_t>(level_) - 1];
  const int16_t* high = source_row(2 * i + 1);
  const auto even = [&](int at) { return line(mirrored(at, height)); };
  const int16_t *a = even(2 * i), *b = even(2 * i + 2), *c = even(2 * i - 2), *d = even(2 * i + 4);
  invert_predict_row(high, {a, b, c, d}, columns(), line(2 * i + 1));
}

// Where a level has no detail at all, its samples beside and below the low band are zero, and lines end with the low ones.
// Even rows first, odd ones as soon as the even ones that they are predicted from are there.
void SpihtDecoder::column_row() {
  const size_t k = static_cast<size_t>(level_);
  const int lows = layout_.height[k], highs = layout_.height[k - 1] - lows;
  if (row_ == 0) dequantize_cells(0);
  dequantize_cells(row_ + 1);
  if (row_ < lows) even_row(row_);
  if (row_ >= kLag && row_ - kLag < highs) odd_row(row_ - kLag);
  spent_ += spiht_units_of_columns(columns());
  if (++row_ < lows + kLag) return;
  row_ = 0;
  phase_ = Phase::kRows;
}

void SpihtDecoder::texel_row() {
  const size_t k = static_cast<size_t>(std::max(level_ - 1, 0));
  if (level_ > 0) invert_line(line(row_), layout_.width[k], detailed(), plane_row(row_));
  if (k == 0) texels_from_samples(plane_row(row_), layout_.width[0]);
  spent_ += spiht_units_of_line(layout_.width[k]);
  if (++row_ < layout_.height[k]) return;
  row_ = 0;
  if (k == 0) return begin_plane(plane_ + 1);
  --level_;
  phase_ = Phase::kColumns;
}

}  // namespace vitrine
