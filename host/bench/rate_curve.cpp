// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/rate_curve.h"

#include <algorithm>
#include <cmath>

#include "host/verify/verify.h"

namespace vitrine {
namespace {

constexpr int kMostTries = 10;
constexpr double kNear = 0.01;        // of the wanted bytes
constexpr double kFinestStep = 0.02;  // of qualities that are no whole numbers
constexpr double kReach = 8;          // of a guess beyond what was tried

double far_from(double bytes, double wanted) { return std::abs(std::log(bytes / wanted)); }

}  // namespace

double Rated::psnr_db() const { return vitrine::psnr_db(squared_error); }

const RateCurve::Point& RateCurve::measure(double quality) {
  auto at = std::lower_bound(points_.begin(), points_.end(), quality, [](const Point& p, double q) { return p.quality < q; });
  if (at == points_.end() || at->quality != quality) at = points_.insert(at, {quality, bytes_(quality), {}});
  return *at;
}

double RateCurve::error_of(double quality) {
  measure(quality);
  for (Point& p : points_)
    if (p.quality == quality) {
      if (!p.squared_error) p.squared_error = error_(quality);
      return *p.squared_error;
    }
  return 0;
}

// By a straight line through the two known points next to the wanted bytes, in their logarithm.
double RateCurve::next_quality(double bytes, double guess) const {
  double next = guess;
  if (points_.size() == 1) next = points_[0].quality + range_.halving * std::log2(points_[0].bytes / bytes);
  if (points_.size() > 1) {
    size_t i = 1;  // the first of the fewer bytes, or the last two
    while (i + 1 < points_.size() && points_[i].bytes > bytes) ++i;
    const Point &a = points_[i - 1], &b = points_[i];
    const double fall = std::log2(a.bytes / b.bytes), slope = fall > 1e-6 ? (b.quality - a.quality) / fall : range_.halving;
    const bool inside = a.bytes >= bytes && bytes >= b.bytes;
    next = a.quality + slope * std::log2(a.bytes / bytes);
    if (inside && b.quality - a.quality > 2 * kFinestStep) {  // never so near an end that nothing is learned
      const double margin = std::max(kFinestStep, 0.1 * (b.quality - a.quality));
      next = std::clamp(next, a.quality + margin, b.quality - margin);
    }
    next = std::clamp(next, points_.front().quality - kReach, points_.back().quality + kReach);
  }
  if (range_.whole_steps) next = std::round(next);
  return std::clamp(next, range_.best, range_.worst);
}

Rated RateCurve::at(double bytes, double guess) {
  const auto known = [&](double quality) {
    return std::any_of(points_.begin(), points_.end(),
                       [&](const Point& p) { return std::abs(p.quality - quality) < kFinestStep; });
  };
  const auto nearest = [&] {
    return *std::min_element(points_.begin(), points_.end(),
                             [&](const Point& a, const Point& b) { return far_from(a.bytes, bytes) < far_from(b.bytes, bytes); });
  };
  for (int i = 0; i < kMostTries; ++i) {
    if (!points_.empty() && far_from(nearest().bytes, bytes) < kNear) break;
    double next = next_quality(bytes, guess);
    if (known(next) && range_.whole_steps) {  // its neighbour on the other side of the wanted bytes
      next += measure(next).bytes > bytes ? 1 : -1;
      if (next < range_.best || next > range_.worst) break;
    }
    if (known(next)) break;
    measure(next);
  }
  const Point near = nearest();
  Rated rated{near.bytes, error_of(near.quality), near.quality};
  if (far_from(near.bytes, bytes) < kNear) return rated;
  for (size_t i = 1; i < points_.size(); ++i) {
    const Point a = points_[i - 1], b = points_[i];
    if (a.bytes < bytes || bytes < b.bytes || a.bytes <= b.bytes) continue;
    const double t = std::log(a.bytes / bytes) / std::log(a.bytes / b.bytes);
    rated.squared_error = std::exp((1 - t) * std::log(error_of(a.quality)) + t * std::log(error_of(b.quality)));
    rated.bytes = bytes;
    break;
  }
  return rated;
}

}  // namespace vitrine
