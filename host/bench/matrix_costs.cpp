// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/matrix_costs.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "host/bench/processor_time.h"
#include "host/infer/bounding_box_reader.h"
#include "host/infer/coordinate_reader.h"
#include "host/infer/eight_bit_reader.h"
#include "host/infer/identifier_reader.h"

namespace vitrine {
namespace {

constexpr int kMostPixelsByBlocks = 320 * 240;  // in which bounding boxes take seconds, not minutes

StateMatrix read_once(MatrixReader& reader, const GeometryState& state) {
  const GeometryState* const states[] = {&state};
  return std::move(reader.read(states).front());
}

StateMatrix read_timed(MatrixReader& reader, const GeometryState& state, MatrixCost& cost) {
  const int64_t before = reader.renderings();
  const double start = wall_seconds();
  StateMatrix matrix = read_once(reader, state);
  cost = {.method = reader.method(), .renderings = reader.renderings() - before, .milliseconds = 1000 * (wall_seconds() - start)};
  return matrix;
}

std::span<const MatrixEntry> row_of(const ObjectMatrix& matrix, size_t sample) {
  return std::span(matrix.entries).subspan(matrix.starts[sample], matrix.starts[sample + 1] - matrix.starts[sample]);
}

float largest_row_sum_error(const StateMatrix& matrix) {
  float largest = 0;
  for (const ObjectMatrix& rows : matrix)
    for (size_t s = 0; s < rows.samples.size(); ++s) {
      float sum = 0;
      for (const MatrixEntry& entry : row_of(rows, s)) sum += entry.weight;
      largest = std::max(largest, std::fabs(sum - 1));
    }
  return largest;
}

// Random texels of all levels, bytes each: what both kinds of devices can hold.
using Bytes = std::vector<std::array<uint8_t, 4>>;
Bytes random_texels(size_t count, std::mt19937& random) {
  Bytes texels(count);
  for (auto& texel : texels)
    for (uint8_t& channel : texel) channel = static_cast<uint8_t>(random() >> 24);
  return texels;
}

glm::vec4 color_of(const std::array<uint8_t, 4>& texel) { return glm::vec4(texel[0], texel[1], texel[2], texel[3]) / 255.0f; }

hal::Texture upload(TestRenderer& renderer, const Pyramid& pyramid, const Bytes& texels) {
  if (renderer.format() == hal::TextureFormat::kRgba8)
    return create_pyramid_texture(renderer.gpu(), renderer.drawer(), pyramid, renderer.format(),
                                  std::as_bytes(std::span(texels)));
  std::vector<glm::vec4> colors(texels.size());
  std::transform(texels.begin(), texels.end(), colors.begin(), color_of);
  return create_pyramid_texture(renderer.gpu(), renderer.drawer(), pyramid, renderer.format(), std::as_bytes(std::span(colors)));
}

// The largest |A x - rendering| over all channels of one object's samples.
float largest_difference_from(std::span<const glm::vec4> picture, const TestRenderer& renderer, const ObjectMatrix& rows,
                              const Bytes& texels) {
  float largest = 0;
  const auto columns = static_cast<uint32_t>(rows.window.width * renderer.supersampling());
  for (size_t s = 0; s < rows.samples.size(); ++s) {
    const uint32_t x = static_cast<uint32_t>(rows.window.x * renderer.supersampling()) + rows.samples[s] % columns,
                   y = static_cast<uint32_t>(rows.window.y * renderer.supersampling()) + rows.samples[s] / columns;
    glm::vec4 sum(0);
    for (const MatrixEntry& entry : row_of(rows, s)) sum += entry.weight * color_of(texels[entry.texel]);
    const size_t place = (static_cast<size_t>(renderer.height()) - 1 - y) * static_cast<size_t>(renderer.width()) + x;
    const glm::vec4 difference = glm::abs(sum - picture[place]);
    largest = std::max({largest, difference.x, difference.y, difference.z, difference.w});
  }
  return largest;
}

float largest_rendering_difference(TestRenderer& renderer, std::span<const TextureSize> sizes, const GeometryState& state,
                                   const StateMatrix& matrix) {
  std::mt19937 random(1);
  std::vector<Bytes> texels;
  std::vector<hal::Texture> textures;
  for (const TextureSize& size : sizes) {
    const Pyramid pyramid(size.width, size.height);
    texels.push_back(random_texels(pyramid.size(), random));
    textures.push_back(upload(renderer, pyramid, texels.back()));
  }
  std::vector<glm::vec4> picture(static_cast<size_t>(renderer.width()) * static_cast<size_t>(renderer.height()));
  renderer.render(state, textures, picture);
  for (const hal::Texture texture : textures) renderer.gpu().destroy(texture);
  float largest = 0;
  for (size_t i = 0; i < matrix.size(); ++i)
    largest = std::max(largest, largest_difference_from(picture, renderer, matrix[i], texels[i]));
  return largest;
}

}  // namespace

std::vector<MatrixCost> measure_matrix_costs(hal::Gpu& gpu, const InferenceOptions& options, std::span<const DrawnObject> objects,
                                             std::span<const TextureSize> sizes, const GeometryState& state) {
  std::vector<MatrixCost> costs;
  StateMatrix reference;
  const auto measure = [&](TestRenderer& renderer, MatrixReader&& reader) {
    MatrixCost& cost = costs.emplace_back();
    const StateMatrix matrix = read_timed(reader, state, cost);
    cost.row_sum_error = largest_row_sum_error(matrix);
    cost.rendering_difference = largest_rendering_difference(renderer, sizes, state, matrix);
    if (reference.empty()) reference = matrix;
    cost.difference = largest_difference(reference, matrix);
  };
  const auto warm = [&](MatrixReader& reader) -> MatrixReader&& { return read_once(reader, state), std::move(reader); };
  TestRenderer floats(gpu, options, objects), bytes(gpu, options, objects, hal::TextureFormat::kRgba8);
  IdentifierReader identifiers(floats, sizes);
  CoordinateReader coordinates(floats, sizes);
  measure(floats, warm(identifiers));
  measure(floats, warm(coordinates));
  measure(bytes, EightBitReader(bytes, sizes));
  if (options.width * options.height <= kMostPixelsByBlocks) measure(floats, BoundingBoxReader(floats, sizes));
  return costs;
}

}  // namespace vitrine
