// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/eight_bit_reader.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/error.h"
#include "host/infer/matrix_assembly.h"

namespace vitrine {
namespace {

constexpr int kLevelSpacing = 3;  // levels between two that are solved at once
constexpr uint32_t kLargestNumber = (1u << 24) - 1;
constexpr int kRowsATask = 32;
constexpr char kOtherDevice[] = "compile on a device with float targets (OSMesa has them)";

// Of solved texels: in the rendering with numbers, and in the four channels of the other one. High, as what is cut off is a
// smaller share of a high one, and some steps apart, so that it differs from one to the next.
constexpr uint8_t kFull = 255;
constexpr std::array<uint8_t, 4> kIntensities{240, 225, 210, 195};

// The slope of the least-squares line through nothing and what the intensities became, in steps of the channel (section 3.4).
float fitted_weight(float full, const glm::vec4& others) {
  float sum = kFull * full, squares = kFull * kFull;
  for (int i = 0; i < 4; ++i) {
    const float intensity = kIntensities[static_cast<size_t>(i)];
    sum += intensity * others[i];
    squares += intensity * intensity;
  }
  return 255 * sum / squares;
}

// What a row lacks of 1 goes to all its entries alike (section 3.4). Entries that would become negative are none.
void correct_row_sum(std::span<MatrixEntry> entries) {
  for (bool settled = false; !settled;) {
    float missing = 1, count = 0;
    for (const MatrixEntry& entry : entries) missing -= entry.weight, count += entry.weight > 0;
    settled = true;
    for (MatrixEntry& entry : entries)
      if (entry.weight > 0 && entry.weight + missing / count <= kSmallestWeight) entry.weight = 0, settled = false;
    for (MatrixEntry& entry : entries)
      if (settled && entry.weight > 0) entry.weight += missing / count;
  }
}

uint32_t byte_of(float channel) { return static_cast<uint32_t>(channel * 255 + 0.5f); }
uint32_t number_of(const glm::vec4& pixel) { return byte_of(pixel.x) | byte_of(pixel.y) << 8 | byte_of(pixel.z) << 16; }

template <typename T>
T with_number(T texel, uint32_t number) {
  texel.red = static_cast<uint8_t>(number);
  texel.green = static_cast<uint8_t>(number >> 8);
  texel.blue = static_cast<uint8_t>(number >> 16);
  return texel;
}

void check_countable(const Pyramid& pyramid) {
  if (pyramid.size() <= kLargestNumber) return;
  throw InputError("graphics device",
                   fmt::format("without float targets it cannot tell the texels of a texture of {} x {} apart", pyramid.width(),
                               pyramid.height()),
                   kOtherDevice);
}

std::vector<int> sizes_of(const Pyramid& pyramid, int Pyramid::Level::*size) {
  std::vector<int> sizes;
  for (const Pyramid::Level& level : pyramid.levels()) sizes.push_back(level.*size);
  return sizes;
}

// Places of a range in a row of `size` texels, each once.
template <typename Body>
void for_each_in(const TexelRange& range, int size, const Body& body) {
  for (int i = range.first; i <= std::min(range.last, range.first + size - 1); ++i) body(((i % size) + size) % size);
}

}  // namespace

// One tap of one state while its renderings come in.
struct EightBitReader::Tap {
  TapRows rows;
  std::vector<unsigned> residues;  // per object: which residues of levels its supersamples reach, as bits
};

struct EightBitReader::State {
  std::vector<glm::vec4> identifiers;  // objects alone, as assemble_taps wants them
  std::vector<Tap> taps;
};

EightBitReader::EightBitReader(TestRenderer& renderer, std::span<const TextureSize> sizes, std::span<const TextureWraps> wraps)
    : renderer_(&renderer) {
  std::vector<Pyramid> pyramids;
  for (const TextureSize& size : sizes) check_countable(pyramids.emplace_back(size.width, size.height));
  for (size_t i = 0; i < pyramids.size(); ++i)
    textures_.push_back(make_texture(pyramids[i], wraps.empty() ? TextureWraps{} : wraps[i], i + 1));
}

EightBitReader::~EightBitReader() {
  for (const Texture& texture : textures_)
    for (const hal::Texture own : {texture.number, texture.residues, texture.pattern, texture.intensities})
      renderer_->gpu().destroy(own);
}

EightBitReader::Texture EightBitReader::make_texture(const Pyramid& pyramid, const TextureWraps& wraps, size_t number) {
  Texture texture{.pyramid = pyramid, .wraps = wraps};
  const std::vector<int> widths = sizes_of(pyramid, &Pyramid::Level::width), heights = sizes_of(pyramid, &Pyramid::Level::height);
  constexpr Texel8 kKinds[kLevelSpacing] = {{kFull, 0, 0, 0}, {0, kFull, 0, 0}, {0, 0, kFull, 0}};
  std::vector<Texel8> residues;
  for (size_t l = 0; l < widths.size(); ++l) {
    const int level = static_cast<int>(l);
    texture.solved.push_back({safe_spacing(widths, level, wraps.u), safe_spacing(heights, level, wraps.v)});
    residues.resize(l + 1 < widths.size() ? pyramid.levels()[l + 1].offset : pyramid.size(), kKinds[l % kLevelSpacing]);
  }
  hal::Gpu& gpu = renderer_->gpu();
  for (hal::Texture* own : {&texture.number, &texture.residues, &texture.pattern, &texture.intensities})
    *own = create_pyramid_texture(gpu, pyramid, hal::TextureFormat::kRgba8, wraps);
  const std::vector<Texel8> numbers(pyramid.size(), with_number(Texel8{}, static_cast<uint32_t>(number)));
  update_pyramid_texture(gpu, texture.number, pyramid, hal::TextureFormat::kRgba8, std::as_bytes(std::span(numbers)));
  update_pyramid_texture(gpu, texture.residues, pyramid, hal::TextureFormat::kRgba8, std::as_bytes(std::span(residues)));
  return texture;
}

// The number of a solved texel to all that a sample can mix with it.
void EightBitReader::fill_neighbourhood(const Texture& texture, size_t level, int x, int y, std::vector<Texel8>& texels) const {
  const auto& levels = texture.pyramid.levels();
  const Pyramid::Level& own = levels[level];
  const auto number = static_cast<uint32_t>(own.offset) + static_cast<uint32_t>(y * own.width + x) + 1;
  for (size_t l = level - std::min<size_t>(level, 1); l < std::min(levels.size(), level + 2); ++l) {
    const TexelRange columns = filter_neighbourhood(x, own.width, levels[l].width, l == level, texture.wraps.u),
                     rows = filter_neighbourhood(y, own.height, levels[l].height, l == level, texture.wraps.v);
    for_each_in(rows, levels[l].height, [&](int row) {
      Texel8* first = texels.data() + levels[l].offset + static_cast<size_t>(row) * static_cast<size_t>(levels[l].width);
      for_each_in(columns, levels[l].width, [&](int column) { first[column] = with_number(first[column], number); });
    });
  }
}

// Pattern p of a level solves the texels with x % columns == p % columns and y % rows == p / columns.
template <typename Body>
void EightBitReader::for_each_solved(const Texture& texture, int residue, int pattern, const Body& body) const {
  for (size_t l = static_cast<size_t>(residue); l < texture.pyramid.levels().size(); l += kLevelSpacing) {
    const Pyramid::Level& level = texture.pyramid.levels()[l];
    const Solved& solved = texture.solved[l];
    if (pattern >= solved.columns * solved.rows) continue;
    for (int y = pattern / solved.columns; y < level.height; y += solved.rows)
      for (int x = pattern % solved.columns; x < level.width; x += solved.columns) body(l, x, y);
  }
}

void EightBitReader::update_patterns(int residue, int pattern) {
  constexpr Texel8 kSolved{kIntensities[0], kIntensities[1], kIntensities[2], kIntensities[3]};
  for (const Texture& texture : textures_) {
    const auto& levels = texture.pyramid.levels();
    std::vector<Texel8> numbers(texture.pyramid.size()), intensities(texture.pyramid.size());
    for_each_solved(texture, residue, pattern, [&](size_t l, int x, int y) {
      const size_t texel =
          levels[l].offset + static_cast<size_t>(y) * static_cast<size_t>(levels[l].width) + static_cast<size_t>(x);
      fill_neighbourhood(texture, l, x, y, numbers);
      numbers[texel].alpha = kFull;
      intensities[texel] = kSolved;
    });
    for (const auto& [own, texels] : {std::pair(texture.pattern, &numbers), std::pair(texture.intensities, &intensities)})
      update_pyramid_texture(renderer_->gpu(), own, texture.pyramid, hal::TextureFormat::kRgba8,
                             std::as_bytes(std::span(*texels)));
  }
}

std::vector<hal::Texture> EightBitReader::textures_of(hal::Texture Texture::*member) const {
  std::vector<hal::Texture> textures;
  for (const Texture& texture : textures_) textures.push_back(texture.*member);
  return textures;
}

void EightBitReader::render(const GeometryState& state, std::span<const hal::Texture> textures, int tap,
                            std::vector<glm::vec4>& picture) {
  picture.resize(static_cast<size_t>(renderer_->width()) * static_cast<size_t>(renderer_->height()));
  renderer_->render_tap(state, textures, tap, picture);
  ++renderings_;
}

// Which object each supersample shows, and which levels each tap reaches.
void EightBitReader::survey(const GeometryState& geometry, State& state) {
  render(geometry, textures_of(&Texture::number), 0, picture_);
  state.identifiers.resize(picture_.size());
  for (size_t s = 0; s < picture_.size(); ++s) state.identifiers[s] = glm::vec4(0, 0, 0, number_of(picture_[s]));
  state.taps.resize(static_cast<size_t>(renderer_->taps()));
  for (int t = 0; t < renderer_->taps(); ++t) {
    Tap& tap = state.taps[static_cast<size_t>(t)];
    tap.rows.reset(picture_.size());
    tap.residues.assign(textures_.size(), 0);
    render(geometry, textures_of(&Texture::residues), t, picture_);
    for (size_t s = 0; s < picture_.size(); ++s) {
      if (state.identifiers[s].w < 0.5f) continue;
      unsigned& residues = tap.residues[static_cast<size_t>(object_of(state.identifiers[s]))];
      for (int residue = 0; residue < kLevelSpacing; ++residue) residues |= unsigned{picture_[s][residue] > 0} << residue;
    }
  }
}

int EightBitReader::pattern_count(int residue, const Tap& tap) const {
  int count = 0;
  for (size_t i = 0; i < textures_.size(); ++i)
    for (size_t l = static_cast<size_t>(residue); l < textures_[i].solved.size(); l += kLevelSpacing)
      if (tap.residues[i] >> residue & 1) count = std::max(count, textures_[i].solved[l].columns * textures_[i].solved[l].rows);
  return count;
}

void EightBitReader::read_pattern(std::span<const GeometryState* const> states, int residue, int pattern) {
  update_patterns(residue, pattern);
  const std::vector<hal::Texture> patterns = textures_of(&Texture::pattern), intensities = textures_of(&Texture::intensities);
  for (size_t i = 0; i < states.size(); ++i)
    for (int t = 0; t < renderer_->taps(); ++t) {
      Tap& tap = states_[i].taps[static_cast<size_t>(t)];
      if (pattern >= pattern_count(residue, tap)) continue;
      render(*states[i], patterns, t, picture_);
      render(*states[i], intensities, t, intensities_);
      collect(states_[i], tap);
    }
}

void EightBitReader::collect(const State& state, Tap& tap) const {
  const auto width = static_cast<size_t>(renderer_->width());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, static_cast<size_t>(renderer_->height()), kRowsATask), [&](const auto& rows) {
    for (size_t s = rows.begin() * width; s < rows.end() * width; ++s) {
      const glm::vec4& pixel = picture_[s];
      if (!(pixel.w > 0) || state.identifiers[s].w < 0.5f) continue;
      const uint32_t number = number_of(pixel);
      if (!number || number > textures_[static_cast<size_t>(object_of(state.identifiers[s]))].pyramid.size())
        throw InputError("graphics device", "it changes a colour that all texels of a sample share", kOtherDevice);
      tap.rows.add(s, number - 1, fitted_weight(pixel.w, intensities_[s]));
    }
  });
}

std::vector<StateMatrix> EightBitReader::read(std::span<const GeometryState* const> states) {
  if (states_.size() < states.size()) states_.resize(states.size());
  for (size_t i = 0; i < states.size(); ++i) survey(*states[i], states_[i]);
  for (int residue = 0; residue < kLevelSpacing; ++residue) {
    int patterns = 0;
    for (size_t i = 0; i < states.size(); ++i)
      for (const Tap& tap : states_[i].taps) patterns = std::max(patterns, pattern_count(residue, tap));
    for (int pattern = 0; pattern < patterns; ++pattern) read_pattern(states, residue, pattern);
  }
  std::vector<StateMatrix> matrices(states.size());
  tbb::parallel_for(size_t{0}, states.size(), [&](size_t i) {
    std::vector<const TapRows*> rows;
    for (Tap& tap : states_[i].taps) {
      for (size_t s = 0; s < states_[i].identifiers.size(); ++s) correct_row_sum(tap.rows.entries(s));
      rows.push_back(&tap.rows);
    }
    matrices[i] = assemble_taps(*renderer_, states_[i].identifiers, textures_.size(), rows);
  });
  return matrices;
}

}  // namespace vitrine
