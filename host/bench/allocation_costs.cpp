// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/allocation_costs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/encode/field_coder.h"
#include "host/encode/price_search.h"

namespace vitrine {
namespace {

std::vector<EncodedField> encode_at(const std::vector<FieldSource>& fields, NodeCoder coder, double price, Progress& progress) {
  EncodeOptions options;
  options.coder = coder;
  options.quantizer = std::sqrt(price / kPricePerStep2);
  return encode_fields(fields, options, progress);
}

double bytes_of(const std::vector<EncodedField>& encoded) {
  double bytes = 0;
  for (const EncodedField& field : encoded) bytes += static_cast<double>(field.bytes());
  return bytes;
}

double price_for(const std::vector<FieldSource>& fields, NodeCoder coder, double wanted, Progress& progress) {
  constexpr int kAttempts = 10;
  constexpr double kNear = 0.01;  // of the wanted bytes
  PriceSearch search(wanted);
  double best = 0, least_miss = INFINITY, price = 1000;
  for (int i = 0; i < kAttempts && least_miss > kNear; ++i) {
    const double bytes = bytes_of(encode_at(fields, coder, price, progress));
    const double miss = std::fabs(bytes / wanted - 1);
    if (miss < least_miss) least_miss = miss, best = price;
    price = search.next(price, bytes);
  }
  return best;
}

class AllocationPlot {
 public:
  explicit AllocationPlot(const Allocation& allocation) : allocation_(allocation), slope_(slope_of(allocation.all())) {
    for (const FieldAllocation& field : allocation.fields)
      for (const AllocationPoint& point : field.curve) {
        least_.bytes = std::min(least_.bytes, floored(point.bytes)), most_.bytes = std::max(most_.bytes, point.bytes);
        least_.squared_error = std::min(least_.squared_error, floored(point.squared_error));
        most_.squared_error = std::max(most_.squared_error, point.squared_error);
      }
  }

  std::string svg() const {
    std::string inside = axes();
    for (size_t f = 0; f < allocation_.fields.size(); ++f) inside += curve(f) + legend(f);
    return fmt::format(
        "<svg xmlns='http://www.w3.org/2000/svg' width='{:.0f}' height='{:.0f}' font-family='sans-serif' font-size='11'>\n"
        "<rect width='100%' height='100%' fill='white'/>\n{}</svg>\n",
        kWidth + kLegend, kHeight, inside);
  }

 private:
  static constexpr double kWidth = 560, kHeight = 460, kMargin = 60, kLegend = 210, kTangent = 28;

  // Logarithms need something: what costs or errs less than a byte or a unit is drawn as one.
  static double floored(double value) { return std::max(value, 1.0); }
  double x_of(double bytes) const {
    return kMargin + (kWidth - 2 * kMargin) * std::log(floored(bytes) / least_.bytes) / x_span();
  }
  double y_of(double error) const {
    return kHeight - kMargin - (kHeight - 2 * kMargin) * std::log(floored(error) / least_.squared_error) / y_span();
  }
  double x_span() const { return std::max(1e-9, std::log(most_.bytes / least_.bytes)); }
  double y_span() const { return std::max(1e-9, std::log(most_.squared_error / least_.squared_error)); }

  std::string axes() const {
    std::string text;
    for (double bytes = 1; bytes <= most_.bytes; bytes *= 10)
      if (bytes >= least_.bytes)
        text += fmt::format(
            "<path d='M{0:.1f} {1}V{2}' stroke='#ddd'/><text x='{0:.1f}' y='{3}' text-anchor='middle'>{4:.0f}</text>\n",
            x_of(bytes), kMargin, kHeight - kMargin, kHeight - kMargin + 16, bytes);
    for (double error = 1; error <= most_.squared_error; error *= 10)
      if (error >= least_.squared_error)
        text +=
            fmt::format("<path d='M{0} {1:.1f}H{2}' stroke='#ddd'/><text x='{3}' y='{4:.1f}' text-anchor='end'>{5:.0e}</text>\n",
                        kMargin, y_of(error), kWidth - kMargin, kMargin - 6, y_of(error) + 4, error);
    return text + fmt::format(
                      "<text x='{0}' y='{1}' text-anchor='middle'>bytes</text>\n"
                      "<text x='{2}' y='{3}'>squared error on the screen; short lines: the slope of all, {4:.0f} a bit; at the "
                      "right: times that</text>\n",
                      kWidth / 2, kHeight - kMargin + 40, kMargin, kMargin - 16, slope_);
  }

  std::string colour(size_t number) const {
    return fmt::format("hsl({:.0f},70%,40%)",
                       360.0 * static_cast<double>(number) / static_cast<double>(allocation_.fields.size()));
  }

  std::string curve(size_t number) const {
    const FieldAllocation& field = allocation_.fields[number];
    std::string points;
    for (const AllocationPoint& point : field.curve)
      points += fmt::format("{:.1f},{:.1f} ", x_of(point.bytes), y_of(point.squared_error));
    return fmt::format(
        "<polyline points='{0}' fill='none' stroke='{1}'/><circle cx='{2:.1f}' cy='{3:.1f}' r='3.5' fill='{1}'/>{4}\n", points,
        colour(number), x_of(field.chosen().bytes), y_of(field.chosen().squared_error), tangent(field.chosen()));
  }

  // A line of the common slope through a point: in logarithms -slope * bits / error.
  std::string tangent(const AllocationPoint& at) const {
    const double dx = (kWidth - 2 * kMargin) / x_span();
    const double dy = (kHeight - 2 * kMargin) / y_span() * slope_ * 8 * floored(at.bytes) / floored(at.squared_error);
    const double scale = kTangent / std::hypot(dx, dy), x = x_of(at.bytes), y = y_of(at.squared_error);
    return fmt::format("<path d='M{:.1f} {:.1f}L{:.1f} {:.1f}' stroke='black' stroke-width='1.5'/>", x - scale * dx,
                       y - scale * dy, x + scale * dx, y + scale * dy);
  }

  std::string legend(size_t number) const {
    const FieldAllocation& field = allocation_.fields[number];
    const double y = kMargin + 18 * static_cast<double>(number);
    return fmt::format("<rect x='{0}' y='{1}' width='12' height='4' fill='{2}'/><text x='{3}' y='{4}'>{5} {6}: {7:.2f}</text>\n",
                       kWidth - kMargin + 16, y, colour(number), kWidth - kMargin + 34, y + 6, field.object, field.layer,
                       slope_of(field.curve) / slope_);
  }

  const Allocation& allocation_;
  double slope_;  // of all fields together
  AllocationPoint least_{INFINITY, INFINITY}, most_{1, 1};
};

}  // namespace

double slope_of(const AllocationCurve& curve) {
  const AllocationPoint &more = curve[kChosenPrice - 1], &less = curve[kChosenPrice + 1];
  if (more.bytes == less.bytes) return std::numeric_limits<double>::quiet_NaN();
  return (less.squared_error - more.squared_error) / (8 * (more.bytes - less.bytes));
}

AllocationCurve Allocation::all() const {
  AllocationCurve sums;
  for (const FieldAllocation& field : fields)
    for (size_t p = 0; p < sums.size(); ++p) {
      sums[p].bytes += field.curve[p].bytes;
      sums[p].squared_error += field.curve[p].squared_error;
    }
  return sums;
}

Allocation measure_allocation(const std::vector<FieldSource>& fields, const std::vector<FieldLabel>& labels, NodeCoder coder,
                              double bytes, Progress& progress) {
  Allocation allocation;
  allocation.price = price_for(fields, coder, bytes, progress);
  for (const FieldLabel& label : labels) allocation.fields.push_back({label.object, label.layer, {}});
  for (size_t p = 0; p < kAllocationPrices.size(); ++p) {
    const auto encoded = encode_at(fields, coder, allocation.price * kAllocationPrices[p], progress);
    for (size_t f = 0; f < fields.size(); ++f)
      allocation.fields[f].curve[p] = {static_cast<double>(encoded[f].bytes()),
                                       fields[f].weight * fields[f].samples_shown * encoded[f].squared_error};
  }
  return allocation;
}

std::string plot_of(const Allocation& allocation) { return AllocationPlot(allocation).svg(); }

}  // namespace vitrine
