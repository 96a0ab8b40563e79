// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/identifier_reader.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "host/infer/matrix_assembly.h"

namespace vitrine {
namespace {

constexpr int kPeriod = 4;       // texels between two that are set at once; also channels of a rendering
constexpr int kLevelPeriod = 3;  // levels between two that are set at once
constexpr int kRenderings = kPeriod * kLevelPeriod;
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

std::vector<hal::Texture> create_identifier_textures(TestRenderer& renderer, std::span<const Pyramid> pyramids) {
  std::vector<hal::Texture> textures;
  for (const Pyramid& pyramid : pyramids) {
    const std::vector<glm::vec4> identifiers = identifier_texels(pyramid, static_cast<int>(textures.size()));
    textures.push_back(create_pyramid_texture(renderer.gpu(), renderer.drawer(), pyramid, hal::TextureFormat::kRgba32f,
                                              std::as_bytes(std::span(identifiers))));
  }
  return textures;
}

// One tap of one state while its renderings come in.
struct IdentifierReader::Tap {
  std::vector<glm::vec4> identifiers, weights;
  TapRows rows;
  unsigned residues = 0;
};

IdentifierReader::IdentifierReader(TestRenderer& renderer, std::span<const TextureSize> sizes, size_t texture_bytes)
    : renderer_(&renderer), patterns_(kRenderings) {
  size_t texels = 0;
  for (const TextureSize& size : sizes) {
    pyramids_.emplace_back(size.width, size.height);
    texels += pyramids_.back().size();
  }
  identifiers_ = create_identifier_textures(renderer, pyramids_);
  keep_patterns_ = texels * sizeof(std::array<uint16_t, 4>) * kRenderings <= texture_bytes;
}

IdentifierReader::~IdentifierReader() {
  for (int r = 0; r < kRenderings; ++r) release_pattern(r);
  for (const hal::Texture texture : identifiers_) renderer_->gpu().destroy(texture);
}

const std::vector<hal::Texture>& IdentifierReader::pattern_textures(int rendering) {
  std::vector<hal::Texture>& textures = patterns_[static_cast<size_t>(rendering)];
  if (!textures.empty()) return textures;
  for (const Pyramid& pyramid : pyramids_) {
    const auto texels = pattern_texels(pyramid, rendering);
    textures.push_back(create_pyramid_texture(renderer_->gpu(), renderer_->drawer(), pyramid, hal::TextureFormat::kRgba16f,
                                              std::as_bytes(std::span(texels))));
  }
  return textures;
}

void IdentifierReader::release_pattern(int rendering) {
  for (const hal::Texture texture : patterns_[static_cast<size_t>(rendering)]) renderer_->gpu().destroy(texture);
  patterns_[static_cast<size_t>(rendering)].clear();
}

void IdentifierReader::render_identifiers(const GeometryState& state, int number, Tap& tap) {
  const size_t size = static_cast<size_t>(renderer_->width()) * static_cast<size_t>(renderer_->height());
  tap.identifiers.resize(size);
  tap.rows.reset(size);
  tap.residues = 0;
  renderer_->render_tap(state, identifiers_, number, tap.identifiers);
  ++renderings_;
  for (const glm::vec4& identifier : tap.identifiers)
    if (identifier.w > 0.5f) tap.residues |= reached_residues(identifier.z);
}

void IdentifierReader::collect(int rendering, Tap& tap) const {
  const auto width = static_cast<size_t>(renderer_->width());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, static_cast<size_t>(renderer_->height()), 32), [&](const auto& rows) {
    for (size_t s = rows.begin() * width; s < rows.end() * width; ++s) {
      const glm::vec4& weights = tap.weights[s];
      for (int channel = 0; channel < kPeriod; ++channel) {
        if (!(weights[channel] > kSmallestWeight)) continue;
        const glm::vec4& identifier = tap.identifiers[s];
        const Pyramid& pyramid = pyramids_[static_cast<size_t>(object_of(identifier))];
        tap.rows.add(s, texel_of(pyramid, identifier, rendering, channel), weights[channel]);
      }
    }
  });
}

StateMatrix IdentifierReader::assemble(std::span<const Tap> taps) const {
  std::vector<const TapRows*> rows;
  for (const Tap& tap : taps) rows.push_back(&tap.rows);
  return assemble_taps(*renderer_, taps[0].identifiers, pyramids_.size(), rows);
}

std::vector<StateMatrix> IdentifierReader::read(std::span<const GeometryState* const> states) {
  const int tap_count = renderer_->taps();
  if (taps_.size() < states.size()) taps_.resize(states.size());
  for (size_t i = 0; i < states.size(); ++i) {
    taps_[i].resize(static_cast<size_t>(tap_count));
    for (int t = 0; t < tap_count; ++t) render_identifiers(*states[i], t, taps_[i][static_cast<size_t>(t)]);
  }
  for (int rendering = 0; rendering < kRenderings; ++rendering) {
    for (size_t i = 0; i < states.size(); ++i) {
      for (int t = 0; t < tap_count; ++t) {
        Tap& tap = taps_[i][static_cast<size_t>(t)];
        if (!(tap.residues >> level_residue(rendering) & 1)) continue;
        tap.weights.resize(tap.identifiers.size());
        renderer_->render_tap(*states[i], pattern_textures(rendering), t, tap.weights);
        ++renderings_;
        collect(rendering, tap);
      }
    }
    if (!keep_patterns_) release_pattern(rendering);
  }
  std::vector<StateMatrix> matrices(states.size());
  tbb::parallel_for(size_t{0}, states.size(), [&](size_t i) { matrices[i] = assemble(taps_[i]); });
  return matrices;
}

}  // namespace vitrine
