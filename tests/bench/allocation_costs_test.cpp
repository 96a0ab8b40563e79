// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/bench/allocation_costs.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/encode/synthetic.h"

namespace vitrine::test {
namespace {

// Three fields that differ in what they show, in how many samples one texture serves, and in what their errors count.
Allocation three_fields(double bytes) {
  std::vector<FieldSource> fields = {synthetic::field({8, 4}, 96, 64), synthetic::field({8}, 128, 96, {.grain = 0.5f, .seed = 3}),
                                     synthetic::field({8, 4}, 64, 64, {.highlight = 3, .seed = 5})};
  fields[1].samples_shown = 4;
  fields[2].weight = 3;
  return measure_allocation(fields, {{"vase", "diffuse"}, {"vase", "specular"}, {"floor", "diffuse"}}, NodeCoder::kDct, bytes,
                            silent_progress());
}

TEST(Allocation, FieldsThatShareOneStorageEndAtOneSlope) {
  const Allocation allocation = three_fields(12000);
  const AllocationCurve all = allocation.all();
  EXPECT_NEAR(all[kChosenPrice].bytes, 12000, 120);
  ASSERT_EQ(allocation.fields.size(), 3u);
  for (const FieldAllocation& field : allocation.fields) {
    EXPECT_NEAR(slope_of(field.curve) / slope_of(all), 1, 0.35) << field.object << " " << field.layer;
    for (size_t p = 1; p < field.curve.size(); ++p) {
      EXPECT_LT(field.curve[p].bytes, field.curve[p - 1].bytes) << field.object << " " << field.layer;
      EXPECT_GT(field.curve[p].squared_error, field.curve[p - 1].squared_error) << field.object << " " << field.layer;
    }
  }
}

TEST(Allocation, TheSlopeIsWhatTheNextBitsTakeOffTheError) {
  const AllocationCurve curve = {{{400, 10}, {300, 100}, {250, 500}, {200, 900}, {100, 9000}}};
  EXPECT_DOUBLE_EQ(slope_of(curve), 1.0);
  EXPECT_TRUE(std::isnan(slope_of({})));
}

TEST(Allocation, ThePlotShowsEveryFieldAndNoNumberThatIsNone) {
  Allocation allocation;
  allocation.price = 1;
  allocation.fields = {{"vase", "diffuse", {{{400, 10}, {300, 100}, {250, 500}, {200, 900}, {100, 9000}}}},
                       {"floor", "specular", {{{50, 0}, {40, 100}, {30, 200}, {20, 300}, {0, 400}}}}};
  const std::string svg = plot_of(allocation);
  for (const char* text : {"vase diffuse: 0.96", "floor specular: 1.20", "</svg>"})
    EXPECT_NE(svg.find(text), std::string::npos) << text << " is not in\n" << svg;
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

}  // namespace
}  // namespace vitrine::test
