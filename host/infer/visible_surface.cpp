// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/visible_surface.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <optional>

namespace vitrine {
namespace {

constexpr int kNumbersInRow = 1024;  // triangle numbers are two coordinates, each exact however it is interpolated
// Samples of an object: in one state, and in all together, but for kFewestSamples in each; about.
constexpr size_t kSamplesOfState = 2500, kSamplesOfObject = 40000, kFewestSamples = 100;
constexpr float kLargestReach = 1.0f / 64;  // of the domain: at a silhouette a pixel reaches over all of it

int cell_of(float coordinate, int cells = VisibleSurface::kCells) {
  return std::clamp(static_cast<int>(coordinate * static_cast<float>(cells)), 0, cells - 1);
}

constexpr int kFiner = VisibleSurface::kCells / VisibleSurface::kCoarseCells;

bool holds(const DomainPart& part, const glm::vec2& uv) {
  const glm::ivec2 cell = glm::ivec2(cell_of(uv.x), cell_of(uv.y)) / kFiner;
  return cell.x >= part.low.x && cell.x < part.high.x && cell.y >= part.low.y && cell.y < part.high.y;
}

std::bitset<VisibleSurface::kCoarseCells> columns_between(int first, int last) {
  using Row = std::bitset<VisibleSurface::kCoarseCells>;
  return (~Row() >> static_cast<size_t>(VisibleSurface::kCoarseCells - 1 - last + first)) << static_cast<size_t>(first);
}

// The same mesh with its triangles' numbers for coordinates.
DrawnObject numbered(const DrawnObject& object) {
  DrawnObject result;
  result.object = object.object;
  result.culled_index_count = object.culled_index_count;
  for (size_t i = 0; i < object.indices.size(); ++i) {
    const MeshVertex& vertex = object.vertices[object.indices[i]];
    const size_t triangle = i / 3;
    result.vertices.push_back({vertex.x, vertex.y, vertex.z, static_cast<float>(triangle % kNumbersInRow),
                               static_cast<float>(triangle / kNumbersInRow)});
    result.indices.push_back(static_cast<uint32_t>(i));
  }
  return result;
}

// A texture of one texel that names its object.
std::vector<hal::Texture> object_textures(TestRenderer& renderer, size_t count) {
  const Pyramid pyramid(1, 1);
  std::vector<hal::Texture> textures;
  for (size_t i = 0; i < count; ++i) {
    const glm::vec4 texel(0, 0, 0, static_cast<float>(i + 1));
    textures.push_back(create_pyramid_texture(renderer.gpu(), renderer.drawer(), pyramid, hal::TextureFormat::kRgba32f,
                                              std::as_bytes(std::span(&texel, 1))));
  }
  return textures;
}

// From places of the picture to texture coordinates of one triangle: both are projections of one another. In double precision:
// triangles far away are smaller than a pixel.
struct TriangleProjection {
  glm::dmat3 weights_from_place;  // (x, y, 1) in clip space after division -> weights of the corners, up to a common factor
  glm::dmat3x2 uv;

  TriangleProjection(const DrawnObject& object, size_t triangle, const glm::mat4& clip_from_object) {
    glm::dmat3 places;
    for (int k = 0; k < 3; ++k) {
      const MeshVertex& v = object.vertices[object.indices[3 * triangle + static_cast<size_t>(k)]];
      const glm::dvec4 clip = glm::dmat4(clip_from_object) * glm::dvec4(v.x, v.y, v.z, 1);
      places[k] = {clip.x, clip.y, clip.w};
      uv[k] = {v.u, v.v};
    }
    weights_from_place = glm::inverse(places);
  }

  // `pixel`: the size of one in clip space. Devices snap corners to a grid, so that a place may lie outside the triangle by a
  // little of a pixel, which on one seen edge-on is far.
  SurfaceSample at(const glm::dvec2& place, const glm::dvec2& pixel) const {
    const glm::dvec3 weights = weights_from_place * glm::dvec3(place, 1);
    const double sum = weights.x + weights.y + weights.z;
    const glm::dvec3 inside = glm::max(weights / sum, glm::dvec3(0));
    const glm::dvec2 at = uv * weights / sum;
    SurfaceSample sample;
    sample.uv = uv * inside / (inside.x + inside.y + inside.z);
    for (int d = 0; d < 2; ++d) {
      const glm::dvec3 change = weights_from_place[d];
      sample.uv_per_pixel[d] = pixel[d] / sum * (uv * change - at * (change.x + change.y + change.z));
    }
    return sample;
  }
};

bool is_finite(const SurfaceSample& s) {
  return std::isfinite(s.uv.x + s.uv.y + s.uv_per_pixel[0][0] + s.uv_per_pixel[0][1] + s.uv_per_pixel[1][0] +
                       s.uv_per_pixel[1][1]);
}

// A rendering of triangle numbers and what it says of one object.
struct NumberedPicture {
  std::span<const glm::vec4> pixels;
  int width, height, supersampling;

  // Places of each object's pixels.
  std::vector<std::vector<uint32_t>> places_of_objects(size_t object_count) const {
    std::vector<std::vector<uint32_t>> places(object_count);
    for (size_t i = 0; i < pixels.size(); ++i) {
      const auto number = static_cast<size_t>(pixels[i].w + 0.5f);
      if (number > 0 && number <= object_count) places[number - 1].push_back(static_cast<uint32_t>(i));
    }
    return places;
  }

  // Of what is shown, about `sample_count` places are kept.
  void survey(const DrawnObject& object, const std::vector<uint32_t>& shown, size_t sample_count,
              const glm::mat4& clip_from_object, VisibleSurface& surface) const {
    const double share = static_cast<double>(shown.size()) / static_cast<double>(sample_count);
    const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(share))));
    const glm::dvec2 size(width, height), pixel = static_cast<double>(2 * supersampling) / size;
    std::vector<VisibleSurface::CellRow> seen(VisibleSurface::kCells);
    std::vector<bool> met(object.indices.size() / 3);
    size_t current = met.size();
    std::optional<TriangleProjection> projection;
    std::optional<SurfaceSample> first;
    for (const uint32_t place : shown) {
      const size_t triangle =
          static_cast<size_t>(pixels[place].x + 0.5f) + kNumbersInRow * static_cast<size_t>(pixels[place].y + 0.5f);
      if (triangle >= met.size()) continue;
      if (triangle != current) projection.emplace(object, current = triangle, clip_from_object);
      const glm::ivec2 at(place % static_cast<uint32_t>(width), place / static_cast<uint32_t>(width));
      const SurfaceSample sample = projection->at(2.0 * (glm::dvec2(at) + 0.5) / size - 1.0, pixel);
      if (!is_finite(sample)) continue;
      if (!first) first = sample;
      seen[static_cast<size_t>(cell_of(sample.uv.y))].set(static_cast<size_t>(cell_of(sample.uv.x)));
      if (at.x % stride == 0 && at.y % stride == 0) surface.add_sample(sample);
      if (!met[triangle]) meet(object, triangle, surface);
      met[triangle] = true;
      meet_around(sample, surface);
    }
    if (first && surface.samples().empty()) surface.add_sample(*first);  // wires that all stand between the strides
    for (int row = 0; row < VisibleSurface::kCells; ++row) surface.see(row, seen[static_cast<size_t>(row)]);
  }

 private:
  static void meet(const DrawnObject& object, size_t triangle, VisibleSurface& surface) {
    glm::vec2 low(1), high(0);
    for (size_t i = 3 * triangle; i < 3 * triangle + 3; ++i) {
      const MeshVertex& v = object.vertices[object.indices[i]];
      low = glm::min(low, glm::vec2(v.u, v.v));
      high = glm::max(high, glm::vec2(v.u, v.v));
    }
    surface.meet(low, high);
  }
  // Triangles finer than the samples lie between them.
  static void meet_around(const SurfaceSample& sample, VisibleSurface& surface) {
    const glm::vec2 reach =
        glm::min(glm::abs(sample.uv_per_pixel[0]) + glm::abs(sample.uv_per_pixel[1]), glm::vec2(kLargestReach));
    surface.meet(sample.uv - reach, sample.uv + reach);
  }
};

}  // namespace

void VisibleSurface::see(int row, const CellRow& cells) {
  if (cells.none()) return;
  for (int i = 0; i < kCells; ++i) {
    if (!cells[static_cast<size_t>(i)]) continue;
    const int first = i;
    while (i + 1 < kCells && cells[static_cast<size_t>(i + 1)]) ++i;
    seen_.push_back({static_cast<int16_t>(row), static_cast<int16_t>(first), static_cast<int16_t>(i)});
  }
}

void VisibleSurface::meet(const glm::vec2& low, const glm::vec2& high) {
  const auto columns = columns_between(cell_of(low.x, kCoarseCells), cell_of(high.x, kCoarseCells));
  for (int row = cell_of(low.y, kCoarseCells); row <= cell_of(high.y, kCoarseCells); ++row)
    met_[static_cast<size_t>(row)] |= columns;
}

bool VisibleSurface::meets(int dimension, int i) const {
  const auto at = static_cast<size_t>(i);
  if (dimension == 1) return met_[at].any();
  return std::any_of(met_.begin(), met_.end(), [&](const auto& row) { return row[at]; });
}

VisibleSurface VisibleSurface::within(const DomainPart& part) const {
  VisibleSurface inside;
  const glm::ivec2 low = kFiner * part.low, last = kFiner * part.high - 1;
  for (const Run& run : seen_) {
    const auto first = std::max<int>(run.first, low.x), end = std::min<int>(run.last, last.x);
    if (run.row < low.y || run.row > last.y || first > end) continue;
    inside.seen_.push_back({run.row, static_cast<int16_t>(first), static_cast<int16_t>(end)});
  }
  for (const SurfaceSample& sample : samples_)
    if (holds(part, sample.uv)) inside.samples_.push_back(sample);
  if (inside.visible() && inside.samples_.empty()) inside.add_sample(*nearest_sample(inside.seen_.front()));
  for (int row = part.low.y; row < part.high.y; ++row)
    inside.met_[static_cast<size_t>(row)] = met_[static_cast<size_t>(row)] & columns_between(part.low.x, part.high.x - 1);
  return inside;
}

const SurfaceSample* VisibleSurface::nearest_sample(const Run& run) const {
  const glm::vec2 at = glm::vec2(run.first, run.row) / float{kCells};
  const auto distance = [&](const SurfaceSample& sample) { return glm::distance(sample.uv, at); };
  return &*std::min_element(samples_.begin(), samples_.end(),
                            [&](const SurfaceSample& a, const SurfaceSample& b) { return distance(a) < distance(b); });
}

void VisibleSurface::merge(const VisibleSurface& other) {
  samples_.insert(samples_.end(), other.samples_.begin(), other.samples_.end());
  seen_.insert(seen_.end(), other.seen_.begin(), other.seen_.end());
  for (size_t row = 0; row < kCoarseCells; ++row) met_[row] |= other.met_[row];
}

std::vector<glm::vec2> VisibleSurface::outline(const glm::vec2& cut) const {
  const auto border = [](int i, float at) {  // of cell i, unwrapped
    const float low = static_cast<float>(i) / kCells;
    return low < at ? low + 1 : low;
  };
  struct Extent {
    float low = 2, high = -1;
  };
  std::vector<Extent> rows(kCells);
  for (const Run& run : seen_) {
    Extent& row = rows[static_cast<size_t>(run.row)];
    row.low = std::min(row.low, border(run.first, cut.x));
    row.high = std::max(row.high, border(run.last, cut.x));
  }
  constexpr float kCell = 1.0f / kCells;
  std::vector<glm::vec2> corners;
  for (int row = 0; row < kCells; ++row) {
    const auto& [low, high] = rows[static_cast<size_t>(row)];
    if (low > high) continue;
    for (const float v : {border(row, cut.y), border(row, cut.y) + kCell})
      for (const float u : {low, high + kCell}) corners.emplace_back(u, v);
  }
  return corners;
}

std::vector<std::vector<VisibleSurface>> survey_surfaces(hal::Gpu& gpu, const InferenceOptions& options,
                                                         std::span<const DrawnObject> objects,
                                                         std::span<const GeometryState> states) {
  std::vector<DrawnObject> meshes;
  for (const DrawnObject& object : objects) meshes.push_back(numbered(object));
  TestRenderer renderer(gpu, options, meshes);
  const std::vector<hal::Texture> textures = object_textures(renderer, objects.size());
  std::vector<glm::vec4> pixels(static_cast<size_t>(renderer.width()) * static_cast<size_t>(renderer.height()));
  const size_t sample_count = std::clamp(kSamplesOfObject / std::max<size_t>(1, states.size()), kFewestSamples, kSamplesOfState);
  std::vector<std::vector<VisibleSurface>> surfaces;
  for (const GeometryState& state : states) {
    renderer.render_coordinates(state, textures, 0, pixels);
    const NumberedPicture picture{pixels, renderer.width(), renderer.height(), options.supersampling};
    const std::vector<std::vector<uint32_t>> places = picture.places_of_objects(objects.size());
    auto& seen = surfaces.emplace_back(objects.size());
    tbb::parallel_for(size_t{0}, objects.size(), [&](size_t i) {
      if (!places[i].empty()) picture.survey(objects[i], places[i], sample_count, state.clip_from_object[i], seen[i]);
    });
  }
  for (const hal::Texture texture : textures) gpu.destroy(texture);
  return surfaces;
}

}  // namespace vitrine
