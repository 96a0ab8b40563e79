// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Bytes and error of a coder over its quality, and what it gives at a wanted size.
#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace vitrine {

struct QualityRange {
  double best = 0, worst = 0;  // the larger a quality's number, the fewer its bytes
  bool whole_steps = false;
  double halving = 6;  // by how much it grows where bytes halve, about
};

// What a coder gives for a number of bytes.
struct Rated {
  double bytes = 0;          // the wanted ones, or what comes nearest where the coder's range ends before
  double squared_error = 0;  // mean, in 8-bit units
  double psnr_db() const;
  double quality = 0;  // the nearest that was coded
};

class RateCurve {
 public:
  using Bytes = std::function<double(double quality)>;
  using Error = std::function<double(double quality)>;  // mean squared error; of qualities whose bytes were asked for
  RateCurve(QualityRange range, Bytes bytes, Error error) : range_(range), bytes_(std::move(bytes)), error_(std::move(error)) {}

  // Looks for a quality that gives `bytes` within 1 %; where steps are too coarse for that, PSNR is interpolated over the
  // logarithm of the bytes between the two qualities next to it. `guess`: a quality to begin with.
  Rated at(double bytes, double guess);

  struct Point {
    double quality = 0, bytes = 0;
    std::optional<double> squared_error;
  };
  const std::vector<Point>& points() const { return points_; }  // by quality, ascending

 private:
  const Point& measure(double quality);
  double error_of(double quality);
  double next_quality(double bytes, double guess) const;

  QualityRange range_;
  Bytes bytes_;
  Error error_;
  std::vector<Point> points_;
};

}  // namespace vitrine
