// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/rendering_matrix.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "host/base/error.h"

namespace vitrine {
namespace {

constexpr int kPeriod = 4;       // texels between two that are set at once; also channels of a rendering
constexpr int kLevelPeriod = 3;  // levels between two that are set at once
constexpr int kRenderings = kPeriod * kLevelPeriod;
constexpr float kSmallestWeight = 1e-6f;  // below the device's own rounding
constexpr uint16_t kHalfOne = 0x3c00;

// Rendering r sets the texels with level % 3 == r / 4 and y % 4 == r % 4, those with x % 4 == c in channel c.
int level_residue(int rendering) { return rendering / kPeriod; }
int row_residue(int rendering) { return rendering % kPeriod; }

std::vector<std::array<uint16_t, 4>> pattern_texels(const Pyramid& pyramid, int rendering) {
  std::vector<std::array<uint16_t, 4>> texels(pyramid.size(), std::array<uint16_t, 4>{});
  for (size_t l = 0; l < pyramid.levels().size(); ++l) {
    if (static_cast<int>(l) % kLevelPeriod != level_residue(rendering)) continue;
    const Pyramid::Level& level = pyramid.levels()[l];
    for (int y = row_residue(rendering); y < level.height; y += kPeriod) {
      auto* row = texels.data() + level.offset + static_cast<size_t>(y) * static_cast<size_t>(level.width);
      for (int x = 0; x < level.width; ++x) row[x][static_cast<size_t>(x % kPeriod)] = kHalfOne;
    }
  }
  return texels;
}

// The number congruent to `residue` in [0, size) that is nearest to `at` (a multiple of `period` apart from each other).
int nearest_congruent(float at, int residue, int period, int size) {
  const int steps = static_cast<int>(std::floor((at - static_cast<float>(residue)) / static_cast<float>(period) + 0.5f));
  const int last = (size - 1 - residue) / period;  // size > residue: the weight is not 0, so the texel exists
  return std::min(residue + period * std::clamp(steps, 0, std::max(0, last)), size - 1);
}

// Texel of the pyramid that gave a weight in channel `channel` of `rendering` at a supersample with this identifier.
uint32_t texel_of(const Pyramid& pyramid, const glm::vec4& identifier, int rendering, int channel) {
  const int levels = static_cast<int>(pyramid.levels().size());
  const int l = nearest_congruent(identifier.z, level_residue(rendering), kLevelPeriod, levels);
  const Pyramid::Level& level = pyramid.levels()[static_cast<size_t>(l)];
  const int x = nearest_congruent(identifier.x * static_cast<float>(level.width) - 0.5f, channel, kPeriod, level.width);
  const int y =
      nearest_congruent(identifier.y * static_cast<float>(level.height) - 0.5f, row_residue(rendering), kPeriod, level.height);
  return static_cast<uint32_t>(level.offset) + static_cast<uint32_t>(y * level.width + x);
}

// Which residues of levels a supersample between levels floor(z) and ceil(z) reaches, as bits.
unsigned reached_residues(float z) {
  const int lower = static_cast<int>(z + kSmallestWeight);
  unsigned bits = 1u << (lower % kLevelPeriod);
  if (z - static_cast<float>(lower) > kSmallestWeight) bits |= 1u << ((lower + 1) % kLevelPeriod);
  return bits;
}

int object_of(const glm::vec4& identifier) { return static_cast<int>(identifier.w + 0.5f) - 1; }

}  // namespace

std::vector<glm::vec4> identifier_texels(const Pyramid& pyramid, int object) {
  std::vector<glm::vec4> texels(pyramid.size());
  for (size_t l = 0; l < pyramid.levels().size(); ++l) {
    const Pyramid::Level& level = pyramid.levels()[l];
    for (int y = 0; y < level.height; ++y)
      for (int x = 0; x < level.width; ++x)
        texels[level.offset + static_cast<size_t>(y) * static_cast<size_t>(level.width) + static_cast<size_t>(x)] = {
            (static_cast<float>(x) + 0.5f) / static_cast<float>(level.width),
            (static_cast<float>(y) + 0.5f) / static_cast<float>(level.height), static_cast<float>(l),
            static_cast<float>(object + 1)};
  }
  return texels;
}

// One state while its renderings come in.
struct MatrixReader::Scratch {
  std::vector<glm::vec4> identifiers, weights;
  std::vector<uint8_t> counts;  // entries so far
  std::vector<std::array<MatrixEntry, kMaxTaps>> entries;
  unsigned residues = 0;
};

MatrixReader::MatrixReader(TestRenderer& renderer, std::span<const DrawnObject> objects, int supersampling, size_t texture_bytes)
    : renderer_(&renderer), supersampling_(supersampling), patterns_(kRenderings) {
  size_t texels = 0;
  for (const DrawnObject& object : objects) {
    pyramids_.emplace_back(object.texture_width, object.texture_height);
    texels += pyramids_.back().size();
    const std::vector<glm::vec4> identifiers = identifier_texels(pyramids_.back(), static_cast<int>(pyramids_.size()) - 1);
    identifiers_.push_back(create_pyramid_texture(renderer.gpu(), renderer.drawer(), pyramids_.back(),
                                                  hal::TextureFormat::kRgba32f, std::as_bytes(std::span(identifiers))));
  }
  keep_patterns_ = texels * sizeof(std::array<uint16_t, 4>) * kRenderings <= texture_bytes;
}

MatrixReader::~MatrixReader() {
  for (int r = 0; r < kRenderings; ++r) release_pattern(r);
  for (const hal::Texture texture : identifiers_) renderer_->gpu().destroy(texture);
}

const std::vector<hal::Texture>& MatrixReader::pattern_textures(int rendering) {
  std::vector<hal::Texture>& textures = patterns_[static_cast<size_t>(rendering)];
  if (!textures.empty()) return textures;
  for (const Pyramid& pyramid : pyramids_) {
    const auto texels = pattern_texels(pyramid, rendering);
    textures.push_back(create_pyramid_texture(renderer_->gpu(), renderer_->drawer(), pyramid, hal::TextureFormat::kRgba16f,
                                              std::as_bytes(std::span(texels))));
  }
  return textures;
}

void MatrixReader::release_pattern(int rendering) {
  for (const hal::Texture texture : patterns_[static_cast<size_t>(rendering)]) renderer_->gpu().destroy(texture);
  patterns_[static_cast<size_t>(rendering)].clear();
}

void MatrixReader::render_identifiers(const GeometryState& state, Scratch& scratch) {
  const size_t size = static_cast<size_t>(renderer_->width()) * static_cast<size_t>(renderer_->height());
  scratch.identifiers.resize(size);
  scratch.counts.assign(size, 0);
  scratch.entries.resize(size);
  scratch.residues = 0;
  renderer_->render(state, identifiers_, scratch.identifiers);
  for (const glm::vec4& identifier : scratch.identifiers)
    if (identifier.w > 0.5f) scratch.residues |= reached_residues(identifier.z);
}

void MatrixReader::collect(int rendering, Scratch& scratch) const {
  const auto width = static_cast<size_t>(renderer_->width());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, static_cast<size_t>(renderer_->height()), 32), [&](const auto& rows) {
    for (size_t s = rows.begin() * width; s < rows.end() * width; ++s) {
      const glm::vec4& weights = scratch.weights[s];
      for (int channel = 0; channel < kPeriod; ++channel) {
        if (!(weights[channel] > kSmallestWeight)) continue;
        const uint8_t count = scratch.counts[s]++;
        if (count >= kMaxTaps) continue;  // reported by assemble
        const glm::vec4& identifier = scratch.identifiers[s];
        const Pyramid& pyramid = pyramids_[static_cast<size_t>(object_of(identifier))];
        scratch.entries[s][count] = {texel_of(pyramid, identifier, rendering, channel), weights[channel]};
      }
    }
  });
}

namespace {

// Bounds of an object in supersamples, rows from the top.
struct Bounds {
  int left = INT32_MAX, top = INT32_MAX, right = -1, bottom = -1;
  void include(int x, int y) {
    left = std::min(left, x);
    right = std::max(right, x);
    top = std::min(top, y);
    bottom = std::max(bottom, y);
  }
};

// Output pixels whose filter (radius 1) reaches the bounds, inside the picture.
PixelWindow window_of(const Bounds& bounds, int supersampling, int width, int height) {
  if (bounds.right < 0) return {};
  const int x0 = std::max(0, bounds.left / supersampling - 1), x1 = std::min(width, bounds.right / supersampling + 2);
  const int y0 = std::max(0, bounds.top / supersampling - 1), y1 = std::min(height, bounds.bottom / supersampling + 2);
  return {x0, y0, x1 - x0, y1 - y0};
}

void sort_by_texel(std::span<MatrixEntry> entries) {  // by insertion: at most eight
  for (size_t i = 1; i < entries.size(); ++i)
    for (size_t j = i; j > 0 && entries[j].texel < entries[j - 1].texel; --j) std::swap(entries[j], entries[j - 1]);
}

void check_weights(std::span<const MatrixEntry> entries, size_t count) {
  double sum = 0;
  for (const MatrixEntry& entry : entries) sum += static_cast<double>(entry.weight);
  if (count <= static_cast<size_t>(MatrixReader::kMaxTaps) && std::fabs(sum - 1) < 1e-4) return;
  throw InputError("graphics device",
                   fmt::format("a sample mixes {} texels with weights that sum to {:.6f}, not trilinearly", count, sum),
                   "compile on a device that filters as the specification says (OSMesa does)");
}

}  // namespace

StateMatrix MatrixReader::assemble(const Scratch& scratch) const {
  const int width = renderer_->width(), height = renderer_->height();
  std::vector<Bounds> bounds(pyramids_.size());
  std::vector<size_t> sample_counts(pyramids_.size()), entry_counts(pyramids_.size());
  const auto for_each_sample = [&](const auto& body) {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const size_t s = static_cast<size_t>(height - 1 - y) * static_cast<size_t>(width) + static_cast<size_t>(x);
        if (scratch.identifiers[s].w > 0.5f) body(x, y, s, static_cast<size_t>(object_of(scratch.identifiers[s])));
      }
  };
  for_each_sample([&](int x, int y, size_t s, size_t object) {
    bounds[object].include(x, y);
    ++sample_counts[object];
    entry_counts[object] += scratch.counts[s];
  });
  StateMatrix matrix(pyramids_.size());
  for (size_t object = 0; object < matrix.size(); ++object) {
    ObjectMatrix& rows = matrix[object];
    rows.window = window_of(bounds[object], supersampling_, width / supersampling_, height / supersampling_);
    rows.samples.reserve(sample_counts[object]);
    rows.starts.reserve(sample_counts[object] + 1);
    rows.starts.push_back(0);
    rows.entries.reserve(entry_counts[object]);
  }
  for_each_sample([&](int x, int y, size_t s, size_t object) {
    ObjectMatrix& rows = matrix[object];
    const size_t count = std::min<size_t>(scratch.counts[s], kMaxTaps);
    auto entries = scratch.entries[s];
    check_weights({entries.data(), count}, scratch.counts[s]);
    sort_by_texel({entries.data(), count});
    const int left = x - rows.window.x * supersampling_, top = y - rows.window.y * supersampling_;
    rows.samples.push_back(static_cast<uint32_t>(top * rows.window.width * supersampling_ + left));
    rows.entries.insert(rows.entries.end(), entries.begin(), entries.begin() + static_cast<ptrdiff_t>(count));
    rows.starts.push_back(static_cast<uint32_t>(rows.entries.size()));
  });
  return matrix;
}

std::vector<StateMatrix> MatrixReader::read(std::span<const GeometryState* const> states) {
  std::vector<Scratch>& scratch = scratch_;
  if (scratch.size() < states.size()) scratch.resize(states.size());
  for (size_t i = 0; i < states.size(); ++i) render_identifiers(*states[i], scratch[i]);
  for (int rendering = 0; rendering < kRenderings; ++rendering) {
    for (size_t i = 0; i < states.size(); ++i) {
      if (!(scratch[i].residues >> level_residue(rendering) & 1)) continue;
      scratch[i].weights.resize(scratch[i].identifiers.size());
      renderer_->render(*states[i], pattern_textures(rendering), scratch[i].weights);
      collect(rendering, scratch[i]);
    }
    if (!keep_patterns_) release_pattern(rendering);
  }
  std::vector<StateMatrix> matrices(states.size());
  tbb::parallel_for(size_t{0}, states.size(), [&](size_t i) { matrices[i] = assemble(scratch[i]); });
  return matrices;
}

}  // namespace vitrine
