// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/texture_coordinates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <vector>

#include "host/infer/convex_hull.h"

namespace vitrine {
namespace {

constexpr size_t kFewSamples = 20000, kSearchedSamples = 2500;  // enough to fit four numbers
constexpr int kIterations = 60;                                 // of conjugate gradients
constexpr int kStretchSteps = 100;
constexpr float kLastStep = 0.02f;         // of the search for a shape
constexpr size_t kEstimatedSamples = 400;  // where the shape is not needed, but what it takes
constexpr float kEstimatedStep = 0.1f;
constexpr double kLargestStretch = 1e4;  // square pixels: what has no area in the texture counts no more
constexpr int kTurns = 90;               // directions of rectangles in a quarter turn
// A turned texture costs the coder more than the texels that a slight turn saves: lines of the surface no longer run along it.
constexpr double kTurnPays = 0.97;

const std::array<glm::dvec2, 4> kSteps = {{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};  // from pixel to pixel

double inner(const glm::dmat2& a, const glm::dmat2& b) { return glm::dot(a[0], b[0]) + glm::dot(a[1], b[1]); }

std::vector<SurfaceSample> thinned(std::span<const SurfaceSample> samples, size_t count = kFewSamples) {
  const size_t stride = samples.size() / count + 1;
  std::vector<SurfaceSample> few;
  for (size_t i = 0; i < samples.size(); i += stride) few.push_back(samples[i]);
  return few;
}

// Texels per unit of u and of v such that a pixel's step along each is a texel in the mean of squares.
glm::dmat2 first_map(std::span<const SurfaceSample> samples) {
  glm::dvec2 sum(0);
  for (const SurfaceSample& s : samples)
    for (int d = 0; d < 2; ++d)
      sum[d] += std::log(std::max(1e-12, glm::length(glm::dvec2(s.uv_per_pixel[0][d], s.uv_per_pixel[1][d]))));
  const double count = static_cast<double>(samples.size());
  return {std::exp(-sum.x / count), 0, 0, std::exp(-sum.y / count)};
}

// The symmetric factor of the polar decomposition: the same stretches without the turn.
glm::dmat2 without_turn(const glm::dmat2& m) {
  const glm::dmat2 square = glm::transpose(m) * m;  // its root, by the theorem of Cayley and Hamilton
  const double root = std::sqrt(std::max(0.0, glm::determinant(square)));
  const double trace = std::sqrt(square[0][0] + square[1][1] + 2 * root);
  return (square + glm::dmat2(root)) / trace;
}

// The least singular value of m, and its left vector.
struct LeastStretch {
  double value;
  glm::dvec2 direction;
};
LeastStretch least_singular(const glm::dmat2& m) {
  const glm::dmat2 square = m * glm::transpose(m);
  const double mean = (square[0][0] + square[1][1]) / 2, half = (square[0][0] - square[1][1]) / 2, off = square[1][0];
  const double spread = std::hypot(half, off);
  const double angle = 0.5 * std::atan2(off, half) + std::numbers::pi / 2;
  return {std::sqrt(std::max(0.0, mean - spread)), {std::cos(angle), std::sin(angle)}};
}

glm::mat2 turn_by(float angle) { return {std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle)}; }

// With as few more texels as keep the stretch below the bound.
glm::mat2 within_bound(std::span<const SurfaceSample> samples, glm::mat2 linear, const TextureFitOptions& options, MapKind kind) {
  for (int step = 0; step < kStretchSteps; ++step) {
    Stretch stretch = greatest_stretch(samples, linear, options.stretch_share);
    if (!(stretch.pixels > options.stretch_bound)) break;
    if (kind == MapKind::kScales)  // along the nearer axis
      stretch.direction = std::fabs(stretch.direction.x) > std::fabs(stretch.direction.y) ? glm::vec2(1, 0) : glm::vec2(0, 1);
    const float factor = stretch.pixels / options.stretch_bound * 1.001f;
    linear = (glm::mat2(1) + (factor - 1) * glm::outerProduct(stretch.direction, stretch.direction)) * linear;
  }
  return linear;
}

// Mean square of a texel's sides on the screen, in pixels, over all that is seen: what is lost between texels grows about so.
double mean_square_stretch(std::span<const SurfaceSample> samples, const glm::mat2& linear) {
  double sum = 0;
  for (const SurfaceSample& sample : samples) {
    const glm::dmat2 texels = glm::dmat2(linear) * glm::dmat2(sample.uv_per_pixel);
    const double determinant = glm::determinant(texels);  // inverse and adjugate have columns of the same lengths but for it
    sum += std::min(inner(texels, texels) / std::max(determinant * determinant, 1e-12), kLargestStretch);
  }
  return sum / static_cast<double>(samples.size());
}

struct Candidate {
  glm::mat2 linear{1};
  double square = 1;      // mean, of its texels' sides on the screen
  double texels = 1e300;  // of its rectangle, were that 1
  glm::vec2 size{0};
};
Candidate candidate_of(std::span<const SurfaceSample> samples, std::span<const glm::vec2> outline, const glm::mat2& linear,
                       float aspect) {
  std::vector<glm::vec2> mapped;
  for (const glm::vec2& point : outline) mapped.push_back(linear * point);
  const Rectangle rectangle = smallest_rectangle(mapped, aspect);
  const double square = mean_square_stretch(samples, linear);
  return {linear, square, rectangle.texels * square, rectangle.size};
}

// exp of the traceless symmetric matrix (p, q; q, -p): stretches by exp(r) one way and by exp(-r) across it, r = |(p, q)|.
glm::mat2 stretch_by(const glm::vec2& pq) {
  const float r = glm::length(pq), c = std::cosh(r), s = r > 0 ? std::sinh(r) / r : 1;
  return {c + s * pq.x, s * pq.y, s * pq.y, c - s * pq.x};
}

// By steps of stretch in eight directions, halved where none helps.
Candidate smallest_from(Candidate best, std::span<const SurfaceSample> samples, std::span<const glm::vec2> outline, float aspect,
                        float last_step) {
  for (float step = 0.4f; step > last_step;) {
    const Candidate before = best;
    for (int direction = 0; direction < 8; ++direction) {
      const float angle = std::numbers::pi_v<float> / 4 * static_cast<float>(direction);
      const glm::mat2 shape = stretch_by(step * glm::vec2(std::cos(angle), std::sin(angle))) * before.linear;
      const Candidate candidate = candidate_of(samples, outline, shape, aspect);
      if (candidate.texels < best.texels) best = candidate;
    }
    if (best.texels > 0.999 * before.texels) step /= 2;
  }
  return best;
}

// An isometry's image of what is seen may fill its rectangle badly, as a rhombus does. So the chapter's map, and the one
// that only scales, are where a search begins for the shape that needs the fewest texels.
Candidate smallest_map(std::span<const SurfaceSample> all, std::span<const glm::vec2> outline, float aspect) {
  const std::vector<SurfaceSample> samples = thinned(all, kSearchedSamples);
  Candidate best;
  for (const MapKind kind : {MapKind::kScales, MapKind::kLinear}) {
    const Candidate candidate = candidate_of(samples, outline, most_isometric_map(samples, kind), aspect);
    if (candidate.texels < best.texels) best = candidate;
  }
  return smallest_from(best, samples, outline, aspect, kLastStep);
}

}  // namespace

float branch_cut(const VisibleSurface& surface, int dimension) {
  constexpr int n = VisibleSurface::kCoarseCells;
  std::array<bool, n> met;
  for (int i = 0; i < n; ++i) met[static_cast<size_t>(i)] = surface.meets(dimension, i);
  int best_first = 0, best_length = 0;
  for (int i = 0; i < n; ++i) {
    int length = 0;
    while (length < n && !met[static_cast<size_t>((i + length) % n)]) ++length;
    if (length > best_length) best_first = i, best_length = length;
  }
  const int middle = best_first + best_length / 2;
  const bool around_border = best_first + best_length >= n || best_first == 0;
  return best_length == 0 || around_border ? 0 : static_cast<float>(middle) / n;
}

double isometry_error(std::span<const SurfaceSample> samples, const glm::dmat2& linear, glm::dmat2* gradient) {
  double sum = 0;
  if (gradient) *gradient = glm::dmat2(0);
  for (const SurfaceSample& sample : samples)
    for (const glm::dvec2& step : kSteps) {
      const glm::dvec2 edge = glm::dmat2(sample.uv_per_pixel) * step, mapped = linear * edge;
      const double s = glm::length(step), t = std::max(1e-12, glm::length(mapped)), shorter = std::min(s, t);
      const double error = (s - t) / shorter;
      sum += error * error;
      // d error^2 / dt: of (s / t - 1)^2 below s, of (t / s - 1)^2 above.
      const double slope = t < s ? -2 * (s / t - 1) * s / (t * t) : 2 * (t - s) / (s * s);
      if (gradient) *gradient += slope / t * glm::outerProduct(mapped, edge);
    }
  return sum;
}

// Polak and Ribiere's directions, restarted where they no longer descend; steps by halving until the error falls.
glm::mat2 most_isometric_map(std::span<const SurfaceSample> all, MapKind kind) {
  const std::vector<SurfaceSample> samples = thinned(all);
  const auto error_of = [&](const glm::dmat2& at, glm::dmat2* slopes) {
    const double error = isometry_error(samples, at, slopes);
    if (kind == MapKind::kScales) (*slopes)[0][1] = (*slopes)[1][0] = 0;
    return error;
  };
  glm::dmat2 map = first_map(samples), gradient, direction(0);
  double error = error_of(map, &gradient), square = inner(gradient, gradient), step = 0.1;
  double last_square = 0;
  glm::dmat2 last_gradient(0);
  for (int i = 0; i < kIterations && square > 0; ++i) {
    const double beta = last_square > 0 ? std::max(0.0, (square - inner(gradient, last_gradient)) / last_square) : 0;
    direction = -gradient + beta * direction;
    if (!(inner(direction, gradient) < 0)) direction = -gradient;
    const double unit = std::sqrt(inner(map, map) / inner(direction, direction));
    glm::dmat2 next_gradient;
    glm::dmat2 next = map;
    double next_error = error;
    for (; step > 1e-6; step /= 2) {
      next = map + step * unit * direction;
      next_error = error_of(next, &next_gradient);
      if (next_error < error) break;
    }
    if (!(next_error < error)) break;
    const bool converged = error - next_error < 1e-7 * error;
    map = next;
    error = next_error;
    last_gradient = gradient;
    last_square = square;
    gradient = next_gradient;
    square = inner(gradient, gradient);
    step *= 4;
    if (converged) break;
  }
  return glm::mat2(without_turn(map));
}

Stretch greatest_stretch(std::span<const SurfaceSample> samples, const glm::mat2& linear, float share) {
  struct Place {
    double texels;  // along a pixel, in the direction where they are fewest
    size_t sample;
    bool operator<(const Place& other) const {
      return texels < other.texels || (texels == other.texels && sample < other.sample);
    }
  };
  std::vector<Place> places;
  for (size_t i = 0; i < samples.size(); ++i)
    places.push_back({least_singular(glm::dmat2(linear) * glm::dmat2(samples[i].uv_per_pixel)).value, i});
  const auto beyond = static_cast<size_t>((1 - share) * static_cast<float>(places.size()));
  const auto at = places.begin() + static_cast<ptrdiff_t>(std::min(beyond, places.size() - 1));
  std::nth_element(places.begin(), at, places.end());
  const LeastStretch least = least_singular(glm::dmat2(linear) * glm::dmat2(samples[at->sample].uv_per_pixel));
  return {static_cast<float>(1 / std::max(least.value, 1e-6)), glm::vec2(least.direction)};
}

Rectangle smallest_rectangle(std::span<const glm::vec2> points, float aspect) {
  constexpr float kHalf = std::numbers::pi_v<float>;
  Rectangle best;
  best.texels = 1e300;
  for (int turn = 0; turn < 2 * kTurns; ++turn) {
    const float angle = kHalf * static_cast<float>(turn) / (2 * kTurns);
    const glm::mat2 turned = turn_by(angle);
    glm::vec2 low(1e30f), high(-1e30f);
    for (const glm::vec2& p : points) {
      low = glm::min(low, turned * p);
      high = glm::max(high, turned * p);
    }
    const glm::vec2 size = high - low;
    if (aspect <= 0 && size.y > size.x * 1.0001f) continue;
    const float width = std::max(size.x, aspect * size.y), height = aspect > 0 ? width / aspect : size.y;
    const double texels = static_cast<double>(width) * static_cast<double>(height) * (turn % kTurns == 0 ? kTurnPays : 1);
    if (texels < best.texels) best = {angle, low, size, texels};
  }
  return best;
}

TextureFit fit_texture(const VisibleSurface& surface, const TextureFitOptions& options, float aspect) {
  TextureFit fit;
  fit.cut = {branch_cut(surface, 0), branch_cut(surface, 1)};
  std::vector<glm::vec2> outline = convex_hull(surface.outline(fit.cut));
  const glm::mat2 shape = smallest_map(surface.samples(), outline, aspect).linear;
  const float stretch = greatest_stretch(surface.samples(), shape, options.stretch_share).pixels;
  const glm::mat2 scaled = options.texels_per_pixel * stretch / options.stretch_bound * shape;
  for (glm::vec2& point : outline) point = scaled * point;
  const Rectangle rectangle = smallest_rectangle(outline, aspect);
  fit.linear = turn_by(rectangle.turn) * scaled;
  fit.low = rectangle.low;
  fit.size = rectangle.size;
  return fit;
}

PatchDemand demand_of(const VisibleSurface& patch) {
  if (!patch.visible()) return {};
  const std::vector<SurfaceSample> samples = thinned(patch.samples(), kEstimatedSamples);
  const std::vector<glm::vec2> outline = convex_hull(patch.outline({branch_cut(patch, 0), branch_cut(patch, 1)}));
  const Candidate first = candidate_of(samples, outline, glm::mat2(first_map(samples)), 0);
  const Candidate shape = smallest_from(first, samples, outline, 0, kEstimatedStep);
  return {shape.texels, std::sqrt(shape.square) * static_cast<double>(shape.size.x + shape.size.y)};
}

glm::vec2 whole_domain_size(const VisibleSurface& surface, const TextureFitOptions& options) {
  const std::vector<SurfaceSample> samples = thinned(surface.samples());
  const glm::mat2 map = within_bound(samples, most_isometric_map(samples, MapKind::kScales), options, MapKind::kScales);
  return options.texels_per_pixel * glm::vec2(map[0][0], map[1][1]);
}

int gutter_of(const TextureFitOptions& options) {
  return 2 * static_cast<int>(std::ceil(kTextureMargin * std::max(1.0f, options.texels_per_pixel)));
}

PatchMap map_of(const TextureFit& fit, const TextureSlot& slot, const TextureSize& texture) {
  PatchMap map{fit.cut, fit.linear, -fit.low};
  const glm::vec2 whole(texture.width, texture.height);
  for (int d = 0; d < 2; ++d) {
    const float scale = static_cast<float>(slot.size[d]) / std::max(fit.size[d], 1e-6f);
    map.offset[d] = (scale * map.offset[d] + static_cast<float>(slot.low[d])) / whole[d];
    for (int column = 0; column < 2; ++column) map.linear[column][d] *= scale / whole[d];
  }
  return map;
}

}  // namespace vitrine
