// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/infer/solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "host/infer/lanes.h"
#include "host/infer/range_penalty.h"

namespace vitrine {
namespace {

// Gamma alone carries slopes on into what no pixel sees, and overshoots there: this share of its strength holds each texel at
// the push-pull value, which does not.
constexpr float kHold = 0.05f;
constexpr int kNewtonSteps = 12;      // of range regularization, at most
constexpr double kSufficient = 1e-4;  // share of the slope by which a Newton step must bring the minimum nearer
constexpr int kHalvings = 30;         // of a Newton step, at most
constexpr size_t kDotBlock = 256;     // texels summed in single precision before they join the double sum

// Sums per channel: a block of texels in single precision, blocks in double.
template <typename T>
class ChannelSums {
 public:
  void add(const T& value) {
    block_ += value;
    if (++count_ == kDotBlock) flush();
  }
  std::array<double, 12> total() {
    flush();
    return sums_;
  }

 private:
  void flush() {
    for (size_t c = 0; c < kChannelsOf<T>; ++c) sums_[c] += static_cast<double>(channel_of(block_, c));
    block_ = {};
    count_ = 0;
  }
  std::array<double, 12> sums_{};
  T block_{};
  size_t count_ = 0;
};

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
  std::vector<float> precision;
  virtual void add(const Observation& observation, std::span<const std::vector<glm::vec3>> layers) = 0;
  virtual std::vector<std::vector<glm::vec3>> solve(const DataTerm& data) = 0;
  virtual size_t bytes() const = 0;
};

template <int K>
struct TextureSolver::Impl final : TextureSolver::Base {
  using T = Lanes<K>;
  using Channels = std::array<double, 12>;
  using Sums = ChannelSums<T>;

  Impl(const Pyramid& pyramid_in, size_t count_in, const SolverOptions& options_in)
      : pyramid(pyramid_in), count(count_in), options(options_in), right(pyramid.size()), diagonal(pyramid.size()) {}

  void add(const Observation& observation, std::span<const std::vector<glm::vec3>> layers) override {
    rows += static_cast<double>(observation.share) * static_cast<double>(observation.rows);
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
    return options.regularization * static_cast<float>(rows / static_cast<double>(pyramid.finest_size()));
  }

  // A symmetric system of equations over the finest level: the normal equations, and what range regularization adds to their
  // diagonal.
  struct System {
    const DataTerm& data;
    std::vector<float> rows;   // row sums of the data term
    std::vector<T> curvature;  // added to the diagonal; empty: nothing
  };

  // out = (M' A' F' scale F A M + mu M' Gamma M + kHold mu + curvature) p; of both the finest level counts, the coarser ones are
  // for work.
  void apply(const System& system, std::vector<T>& p, std::vector<T>& out) const {
    const float mu = strength(), hold = kHold * mu;
    pyramid.decimate(p.data());
    std::fill(out.begin(), out.end(), T{});
    pyramid.add_gamma_gradient(p.data(), mu, out.data());
    system.data.add_product(p.data(), out.data());
    pyramid.decimate_transposed(out.data());
    for (size_t i = 0; i < pyramid.finest_size(); ++i) out[i] += hold * p[i];
    for (size_t i = 0; i < system.curvature.size(); ++i) out[i] += system.curvature[i] * p[i];
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
  static T reciprocal(T value) {
    for (size_t c = 0; c < T::kChannels; ++c) value.set(c, 1 / value[c]);
    return value;
  }

  // By the row sums of the normal equations, which are the diagonal of a matrix that is no smaller. Channels differ only where
  // there is curvature.
  T precondition(const System& system, size_t i, const T& r) const {
    const float row = system.rows[i] + strength() + 1e-12f;
    if (system.curvature.empty()) return (1 / row) * r;
    T sum = system.curvature[i];
    for (size_t c = 0; c < T::kChannels; ++c) sum.set(c, sum[c] + row);
    return reciprocal(sum) * r;
  }

  // Improves x until the preconditioned residual of `right_side` - system x is below the tolerance. `right_side` is spent.
  void conjugate_gradients(const System& system, std::vector<T>& right_side, std::vector<T>& x) const {
    const size_t n = pyramid.finest_size();
    std::vector<T>& r = right_side;
    std::vector<T> p(pyramid.size()), q(pyramid.size());
    std::copy(x.begin(), x.end(), p.begin());
    apply(system, p, q);
    Sums reference, rho;
    for (size_t i = 0; i < n; ++i) {
      reference.add(r[i] * precondition(system, i, r[i]));
      r[i] -= q[i];
      p[i] = precondition(system, i, r[i]);
      rho.add(r[i] * p[i]);
    }
    Channels residual = rho.total(), bound = reference.total();
    for (double& b : bound) b *= static_cast<double>(options.tolerance) * static_cast<double>(options.tolerance);
    std::array<bool, 12> active{};
    for (int iteration = 0; iteration < options.iterations; ++iteration) {
      bool any = false;
      for (size_t c = 0; c < T::kChannels; ++c) any |= active[c] = (iteration == 0 || active[c]) && residual[c] > bound[c];
      if (!any) break;
      residual = step(system, active, residual, x, r, p, q);
    }
  }

  // One step of the search; what the preconditioned residual is after it.
  Channels step(const System& system, const std::array<bool, 12>& active, const Channels& residual, std::vector<T>& x,
                std::vector<T>& r, std::vector<T>& p, std::vector<T>& q) const {
    const size_t n = x.size();
    apply(system, p, q);
    Sums curvature, rho;
    for (size_t i = 0; i < n; ++i) curvature.add(p[i] * q[i]);
    const T alpha = lanes(ratio(residual, curvature.total(), active));
    for (size_t i = 0; i < n; ++i) {
      x[i] += alpha * p[i];
      r[i] -= alpha * q[i];
      q[i] = precondition(system, i, r[i]);
      rho.add(r[i] * q[i]);
    }
    const Channels next = rho.total();
    const T beta = lanes(ratio(next, residual, active));
    for (size_t i = 0; i < n; ++i) p[i] = q[i] + beta * p[i];
    return next;
  }

  // The weight of the sum of g beside half the squared errors, whose gradient `apply` and right sides are.
  double range_weight() const {
    const double white = static_cast<double>(options.white), rows_per_texel = rows / static_cast<double>(pyramid.finest_size());
    return 0.5 * static_cast<double>(options.range_regularization) * rows_per_texel * range_calibration() * white * white;
  }

  // Newton's method for the convex sum of the quadratic function whose minimum is system x = b, and range regularization.
  void keep_in_range(System& system, const std::vector<T>& b, std::vector<T>& x) const {
    const size_t n = pyramid.finest_size();
    const float white = options.white;
    for (T& texel : x)
      for (size_t c = 0; c < T::kChannels; ++c) texel.set(c, std::clamp(texel[c], 0.0f, white));
    std::vector<T> work(pyramid.size()), gradient(pyramid.size());
    for (int newton = 0; newton < kNewtonSteps; ++newton) {
      system.curvature.clear();
      std::copy(x.begin(), x.end(), work.begin());
      apply(system, work, gradient);
      system.curvature.resize(n);
      std::vector<T> down(n);
      for (size_t i = 0; i < n; ++i) {
        gradient[i] -= b[i];
        add_range_gradient(x[i], gradient[i], system.curvature[i]);
        down[i] -= gradient[i];
      }
      std::vector<T> direction(n);
      conjugate_gradients(system, down, direction);
      if (!search_along(system, direction, gradient, work, x)) break;
    }
    system.curvature.clear();
  }

  void add_range_gradient(const T& texel, T& gradient, T& curvature) const {
    const double weight = range_weight(), white = static_cast<double>(options.white);
    for (size_t c = 0; c < T::kChannels; ++c) {
      const RangePenalty g = range_penalty(static_cast<double>(texel[c]) / white);
      gradient.set(c, gradient[c] + static_cast<float>(weight * g.slope / white));
      curvature.set(c, static_cast<float>(weight * g.curvature / (white * white)));
    }
  }

  // Goes as far along `direction` as lessens the function enough (Armijo's rule) and stays inside the range, each channel by
  // itself; whether any channel moved by more than a thousandth of white. `gradient`: of the function at x.
  bool search_along(const System& system, const std::vector<T>& direction, const std::vector<T>& gradient, std::vector<T>& work,
                    std::vector<T>& x) const {
    const size_t n = x.size();
    Sums slopes, curvatures;
    std::vector<T> product(pyramid.size());
    std::copy(direction.begin(), direction.end(), work.begin());
    const System quadratic{system.data, {}, {}};
    apply(quadratic, work, product);
    for (size_t i = 0; i < n; ++i) slopes.add(direction[i] * gradient[i]), curvatures.add(direction[i] * product[i]);
    const Channels slope = slopes.total(), curvature = curvatures.total();
    bool moved = false;
    for (size_t c = 0; c < T::kChannels; ++c) {
      double step = slope[c] < 0 ? 1 : 0;
      for (int h = 0; step > 0; ++h, step *= 0.5) {
        if (h == kHalvings) step = 0;
        // The quadratic part of the change is exact: its slope is the whole slope without that of g.
        if (change_along(c, direction, x, step) + 0.5 * step * step * curvature[c] + step * slope[c] <=
            kSufficient * step * slope[c])
          break;
      }
      float largest = 0;
      for (size_t i = 0; i < n && step > 0; ++i) {
        const float by = static_cast<float>(step) * direction[i][c];
        largest = std::max(largest, std::fabs(by));
        x[i].set(c, x[i][c] + by);
      }
      moved |= largest > 1e-3f * options.white;
    }
    return moved;
  }

  // By how much the weighted sum of g exceeds its tangent after `step`; infinite outside the range.
  double change_along(size_t channel, const std::vector<T>& direction, const std::vector<T>& x, double step) const {
    const double white = static_cast<double>(options.white);
    double sum = 0;
    for (size_t i = 0; i < x.size(); ++i) {
      const double from = static_cast<double>(x[i][channel]) / white;
      const double by = step * static_cast<double>(direction[i][channel]) / white;
      // Single precision must hold it, too.
      if (from + by <= -0.999 * kRangeMargin || from + by >= 1 + 0.999 * kRangeMargin) return INFINITY;
      const RangePenalty here = range_penalty(from);
      sum += range_penalty(from + by).value - here.value - by * here.slope;
    }
    return range_weight() * sum;
  }

  std::vector<T> minimum(const DataTerm& data) {
    std::vector<T> b = std::move(right);
    pyramid.decimate_transposed(b.data());
    pyramid.decimate_transposed(diagonal.data());
    precision.assign(diagonal.begin(), diagonal.begin() + static_cast<ptrdiff_t>(pyramid.finest_size()));
    std::vector<T> x = push_pull(pyramid, b, diagonal, std::max(strength(), 1e-6f));
    System system{data, std::move(diagonal), {}};
    for (size_t i = 0; i < x.size(); ++i) b[i] += kHold * strength() * x[i];
    if (options.range_regularization <= 0) {
      conjugate_gradients(system, b, x);
      return x;
    }
    std::vector<T> spent = b;
    conjugate_gradients(system, spent, x);
    keep_in_range(system, b, x);
    return x;
  }

  std::vector<std::vector<glm::vec3>> solve(const DataTerm& data) override {
    const std::vector<T> x = minimum(data);
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
  double rows = 0;              // by their shares
  std::vector<T> right;         // A' F' (share W^2 / c) b over all levels
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
std::vector<std::vector<glm::vec3>> TextureSolver::solve(const DataTerm& data) { return impl_->solve(data); }
const std::vector<float>& TextureSolver::precision() const { return impl_->precision; }
size_t TextureSolver::bytes() const { return impl_->bytes(); }

void add_importance(const Observation& observation, float factor, std::vector<float>& all_levels) {
  std::vector<float> pixels(observation.matrix->pixel_count());
  for (size_t p = 0; p < pixels.size(); ++p)
    if (observation.weight[p] > 0) pixels[p] = factor * observation.weight[p] / observation.matrix->filtered()[p];
  observation.matrix->add_transposed(pixels.data(), all_levels.data());
}

}  // namespace vitrine
