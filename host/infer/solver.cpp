// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/solver.h"

#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "host/infer/lanes.h"

namespace vitrine {
namespace {

// States of a stack are summed in this many partial sums, whatever the number of threads.
constexpr size_t kPartialSums = 4;
// Gamma alone carries slopes on into what no pixel sees, and overshoots there: this share of its strength holds each texel at
// the push-pull value, which does not.
constexpr float kHold = 0.05f;
constexpr size_t kDotBlock = 256;  // texels summed in single precision before they join the double sum

// Per channel: sum of a * b (* c).
template <typename T>
std::array<double, 12> dot(const std::vector<T>& a, const std::vector<T>& b) {
  std::array<double, 12> sums{};
  for (size_t begin = 0; begin < a.size(); begin += kDotBlock) {
    T partial{};
    for (size_t i = begin; i < std::min(begin + kDotBlock, a.size()); ++i) partial += a[i] * b[i];
    for (size_t c = 0; c < kChannelsOf<T>; ++c) sums[c] += static_cast<double>(channel_of(partial, c));
  }
  return sums;
}

// Push-pull (Gortler et al. 1996, "The Lumigraph", section 3.4): texels that the data hardly reach take the value of the
// next coarser level. `sum`: weighted values, `weight`: weights, both on the finest level.
template <typename T>
std::vector<T> push_pull(const Pyramid& pyramid, std::vector<T> sum, std::vector<float> weight, float doubt) {
  const auto& levels = pyramid.levels();
  sum.resize(pyramid.size());
  weight.resize(pyramid.size());
  pyramid.decimate(sum.data());
  pyramid.decimate(weight.data());
  for (size_t l = levels.size(); l-- > 0;) {
    const bool top = l + 1 == levels.size();
    for (int y = 0; y < levels[l].height; ++y)
      for (int x = 0; x < levels[l].width; ++x) {
        const size_t i =
            levels[l].offset + static_cast<size_t>(y) * static_cast<size_t>(levels[l].width) + static_cast<size_t>(x);
        const T coarser = top ? T{} : pyramid.interpolate(sum.data(), l, x, y);
        sum[i] = (1 / std::max(weight[i] + (top ? 0 : doubt), 1e-20f)) * (sum[i] + (top ? 0 : doubt) * coarser);
      }
  }
  sum.resize(pyramid.finest_size());
  return sum;
}

}  // namespace

struct TextureSolver::Base {
  virtual ~Base() = default;
  virtual void add(const Observation& observation, std::span<const std::vector<glm::vec3>> layers) = 0;
  virtual std::vector<std::vector<glm::vec3>> solve() const = 0;
  virtual size_t bytes() const = 0;
};

template <int K>
struct TextureSolver::Impl final : TextureSolver::Base {
  using T = Lanes<K>;
  using Channels = std::array<double, 12>;

  Impl(const Pyramid& pyramid_in, size_t count_in, const SolverOptions& options_in)
      : pyramid(pyramid_in), count(count_in), options(options_in), right(pyramid.size()), diagonal(pyramid.size()) {}

  void add(const Observation& observation, std::span<const std::vector<glm::vec3>> layers) override {
    observations.push_back(&observation);
    rows += observation.rows;
    const size_t pixels = observation.matrix->pixel_count();
    std::vector<T> targets(pixels);
    std::vector<float> ones(pixels);
    for (size_t p = 0; p < pixels; ++p) {
      if (observation.weight[p] <= 0) continue;
      const float c = observation.matrix->filtered()[p], factor = observation.scale[p] * c;
      ones[p] = factor;
      for (size_t i = 0; i < count; ++i)
        for (int k = 0; k < 3; ++k) targets[p].set(3 * i + static_cast<size_t>(k), factor * layers[i][p][k]);
    }
    observation.matrix->add_transposed(targets.data(), right.data());
    observation.matrix->add_transposed(ones.data(), diagonal.data());
  }

  float strength() const {
    return options.regularization * static_cast<float>(static_cast<double>(rows) / static_cast<double>(pyramid.finest_size()));
  }

  // all_out += A' F' scale F A all_in for the states s, s + step, ...
  void add_data_term(const T* all_in, size_t first, size_t step, T* all_out) const {
    std::vector<T> pixels;
    for (size_t s = first; s < observations.size(); s += step) {
      const Observation& observation = *observations[s];
      pixels.resize(observation.matrix->pixel_count());
      observation.matrix->apply(all_in, pixels.data());
      for (size_t p = 0; p < pixels.size(); ++p) pixels[p] = observation.scale[p] * pixels[p];
      observation.matrix->add_transposed(pixels.data(), all_out);
    }
  }

  // out = (M' A' F' scale F A M + mu M' Gamma M + kHold mu) x.
  struct Workspace {
    std::vector<T> in;
    std::array<std::vector<T>, kPartialSums> sums;
  };
  void apply(const std::vector<T>& x, std::vector<T>& out, Workspace& work) const {
    work.in.resize(pyramid.size());
    std::copy(x.begin(), x.end(), work.in.begin());
    pyramid.decimate(work.in.data());
    const size_t parts = std::clamp<size_t>(observations.size(), 1, kPartialSums);
    // A context of its own: an interruption of the work around this would leave the sums undone without a word.
    tbb::task_group_context context(tbb::task_group_context::isolated);
    tbb::parallel_for(
        size_t{0}, parts,
        [&](size_t part) {
          work.sums[part].assign(pyramid.size(), T{});
          if (part == 0) pyramid.add_gamma_gradient(work.in.data(), strength(), work.sums[0].data());
          add_data_term(work.in.data(), part, parts, work.sums[part].data());
        },
        context);
    std::vector<T>& total = work.sums[0];
    for (size_t part = 1; part < parts; ++part)
      for (size_t i = 0; i < total.size(); ++i) total[i] += work.sums[part][i];
    pyramid.decimate_transposed(total.data());
    const float hold = kHold * strength();
    for (size_t i = 0; i < out.size(); ++i) out[i] = total[i] + hold * x[i];
  }

  static Channels ratio(const Channels& a, const Channels& b, const std::array<bool, 12>& active) {
    Channels result{};
    for (size_t c = 0; c < 12; ++c) result[c] = active[c] && b[c] > 0 ? a[c] / b[c] : 0;
    return result;
  }
  static T lanes(const Channels& values) {
    T result;
    for (size_t c = 0; c < T::kChannels; ++c) result.set(c, static_cast<float>(values[c]));
    return result;
  }

  std::vector<T> conjugate_gradients() const {
    const size_t n = pyramid.finest_size();
    std::vector<T> b = right;
    std::vector<float> weight = diagonal;
    pyramid.decimate_transposed(b.data());
    pyramid.decimate_transposed(weight.data());
    b.resize(n);
    weight.resize(n);
    const float mu = strength();
    std::vector<float> inverse(n);
    for (size_t i = 0; i < n; ++i) inverse[i] = 1 / (weight[i] + mu + 1e-12f);

    Workspace work;
    std::vector<T> x = push_pull(pyramid, b, weight, std::max(mu, 1e-6f)), r(n), z(n), q(n);
    const float hold = kHold * mu;
    for (size_t i = 0; i < n; ++i) b[i] += hold * x[i];
    apply(x, r, work);
    for (size_t i = 0; i < n; ++i) z[i] = inverse[i] * b[i];
    const Channels reference = dot(b, z);
    for (size_t i = 0; i < n; ++i) {
      r[i] = b[i] - r[i];
      z[i] = inverse[i] * r[i];
    }
    std::vector<T> p = z;
    Channels rho = dot(r, z);
    const double bound = static_cast<double>(options.tolerance) * static_cast<double>(options.tolerance);
    std::array<bool, 12> active{};
    for (int iteration = 0; iteration < options.iterations; ++iteration) {
      bool any = false;
      for (size_t c = 0; c < T::kChannels; ++c) any |= active[c] = (iteration == 0 || active[c]) && rho[c] > bound * reference[c];
      if (!any) break;
      apply(p, q, work);
      const T alpha = lanes(ratio(rho, dot(p, q), active));
      for (size_t i = 0; i < n; ++i) {
        x[i] += alpha * p[i];
        r[i] -= alpha * q[i];
        z[i] = inverse[i] * r[i];
      }
      const Channels next = dot(r, z);
      const T beta = lanes(ratio(next, rho, active));
      for (size_t i = 0; i < n; ++i) p[i] = z[i] + beta * p[i];
      rho = next;
    }
    return x;
  }

  std::vector<std::vector<glm::vec3>> solve() const override {
    const std::vector<T> x = conjugate_gradients();
    std::vector<std::vector<glm::vec3>> textures(count, std::vector<glm::vec3>(x.size()));
    for (size_t t = 0; t < count; ++t)
      for (size_t i = 0; i < x.size(); ++i)
        for (int k = 0; k < 3; ++k) textures[t][i][k] = std::max(0.0f, x[i][3 * t + static_cast<size_t>(k)]);
    return textures;
  }
  size_t bytes() const override { return pyramid.size() * (sizeof(T) + sizeof(float)); }

  const Pyramid& pyramid;
  size_t count;
  SolverOptions options;
  std::vector<const Observation*> observations;
  int64_t rows = 0;
  std::vector<T> right;         // A' F' (W^2 / c) b over all levels
  std::vector<float> diagonal;  // the same of 1: row sums of the normal equations
};

TextureSolver::TextureSolver(const Pyramid& pyramid, size_t count, const SolverOptions& options) {
  if (count <= 1)
    impl_ = std::make_unique<Impl<1>>(pyramid, count, options);
  else if (count == 2)
    impl_ = std::make_unique<Impl<2>>(pyramid, count, options);
  else
    impl_ = std::make_unique<Impl<3>>(pyramid, std::min(count, kMaxTextures), options);
}
TextureSolver::~TextureSolver() = default;
TextureSolver::TextureSolver(TextureSolver&&) noexcept = default;
void TextureSolver::add(const Observation& observation, std::span<const std::vector<glm::vec3>> layers) {
  impl_->add(observation, layers);
}
std::vector<std::vector<glm::vec3>> TextureSolver::solve() const { return impl_->solve(); }
size_t TextureSolver::bytes() const { return impl_->bytes(); }

void add_importance(const Observation& observation, float factor, std::vector<float>& all_levels) {
  std::vector<float> pixels(observation.matrix->pixel_count());
  for (size_t p = 0; p < pixels.size(); ++p)
    if (observation.weight[p] > 0) pixels[p] = factor * observation.weight[p] / observation.matrix->filtered()[p];
  observation.matrix->add_transposed(pixels.data(), all_levels.data());
}

}  // namespace vitrine
