// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The one-dimensional root finder of storage allocation: which price of a bit makes the bytes what they shall be.
#pragma once

#include <algorithm>
#include <cmath>

namespace vitrine {

// Bytes fall with the price, roughly as a power of it. Proposes prices by the secant through the nearest points on both
// sides of the target in log-log coordinates.
class PriceSearch {
 public:
  explicit PriceSearch(double target) : target_(std::log(std::max(target, 1.0))) {}

  // The next price to try, given the bytes at one.
  double next(double price, double bytes) {
    const Point at{std::log(price), std::log(std::max(bytes, 1.0))};
    learn_slope(at);
    (at.bytes > target_ ? above_ : below_) = at;
    (at.bytes > target_ ? has_above_ : has_below_) = true;
    if (has_above_ && has_below_) return std::exp(between());
    const double step = std::clamp((at.bytes - target_) / slope_, -kMaxStep, kMaxStep);
    return std::exp(std::clamp(at.price + 1.02 * step, kLeast, kMost));
  }

 private:
  struct Point {
    double price = 0, bytes = 0;
  };
  void learn_slope(const Point& at) {
    if (tried_ && std::fabs(at.price - last_.price) > 1e-3) {
      slope_ = std::clamp((last_.bytes - at.bytes) / (at.price - last_.price), 0.1, 1.5);
    }
    last_ = at;
    tried_ = true;
  }
  double between() const {
    const double span = above_.bytes - below_.bytes;
    const double t = span > 1e-9 ? std::clamp((above_.bytes - target_) / span, 0.02, 0.98) : 0.5;
    return above_.price + t * (below_.price - above_.price);
  }

  static constexpr double kMaxStep = 4, kLeast = -20, kMost = 30;
  double target_;
  double slope_ = 0.55;  // of falling bytes; what is usual until two prices were tried
  Point above_, below_, last_;
  bool has_above_ = false, has_below_ = false, tried_ = false;
};

}  // namespace vitrine
