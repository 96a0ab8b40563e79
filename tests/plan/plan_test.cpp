// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/plan/plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <random>
#include <set>

#include "host/plan/anchors.h"
#include "host/plan/demand.h"
#include "host/plan/level_costs.h"
#include "host/plan/sustained.h"

namespace vitrine {
namespace {

Profile test_profile(uint64_t units = 1'000'000, uint64_t cache = uint64_t{1} << 40) {
  return {"test", units, uint64_t{1} << 30, cache, 2, 60};
}

// A field with full pyramids whose nodes cost what `units_of` says.
template <typename UnitsOf>
EncodedField make_encoded(const ParameterSpace& space, AxisMask axes, int block, int stagger, UnitsOf units_of) {
  EncodedField field;
  field.shape.space = space.restricted(axes);
  int levels = 1;
  while (1 << (levels - 1) < block) ++levels;
  field.shape.pyramid.level_count = levels;
  for (int a = 0; a < space.axis_count; ++a) {
    const bool varies = field.shape.space.axes[a].samples > 1;
    field.shape.block_size[a] = static_cast<uint8_t>(varies ? block : 1);
    field.shape.stagger[a] = static_cast<uint8_t>(varies ? stagger : 0);
    for (int l = 0; l < levels; ++l) field.shape.pyramid.cell[l][a] = static_cast<uint8_t>(varies ? block >> l : 1);
  }
  EXPECT_TRUE(field.shape.valid());
  for (int node = 0; node < field.shape.node_count(); ++node) {
    const bool on_grid = field.shape.samples_of(node).last[0] >= 0;
    field.node_units.push_back(on_grid ? units_of(node) : 0);
    field.node_bytes.push_back(on_grid && field.node_units.back() > 0 ? 1 : 0);
  }
  return field;
}

ParameterSpace make_space(std::initializer_list<AxisShape> axes) {
  ParameterSpace space;
  for (const AxisShape& axis : axes) space.axes[space.axis_count++] = axis;
  return space;
}

// ---- closed forms ----

// One axis, blocks of one sample below the pinned tops of two: every step brings one leaf in.
TEST(Plan, OneLeafAStepNeedsItsUnitsOverTheFramesThatItHas) {
  const ParameterSpace space = make_space({{AxisKind::kLinear, 2001}});
  const EncodedField field = make_encoded(space, 1, 2, 0, [](int) { return 10'000u; });
  const Plan plan = make_plan(space, {0.25f}, {{1, &field, 32, 32}}, false, test_profile());
  // A leaf enters with a step and has the frame of the step and the horizon's; and one tile more, which is the whole node.
  EXPECT_EQ(plan.horizon_frames, 1u);
  EXPECT_EQ(plan.units_worst, 10'000 / 2 + 10'000u);
  // With a long horizon what counts is a leaf every 4 frames.
  const AnchorLattice anchors(space, {0.25f}, false);
  EXPECT_NEAR(static_cast<double>(worst_sustained_units(anchors, find_demand(anchors, {{1, &field, 32, 32}}, 64), 64)), 2500, 90);
  EXPECT_EQ(plan.settle_frames, 1u);
  // Resident: 1 shown + 1 on either side; tops: 1001.
  EXPECT_EQ(plan.cache_bytes, (1001 + 3) * 6u * 32 * 32);
}

TEST(Plan, StillSpacesNeedNothingAfterTheFirstFrame) {
  const ParameterSpace space = make_space({});
  const EncodedField field = make_encoded(space, 0, 1, 0, [](int) { return 500u; });
  const Plan plan = make_plan(space, {}, {{0, &field, 8, 8}}, true, test_profile());
  EXPECT_EQ(plan.settle_frames, 0u);
  EXPECT_EQ(plan.upload_worst, 8u * (64 + 16 + 4 + 1)) << "once, in the first frame";
  EXPECT_EQ(plan.cache_bytes, 6u * 64);
  EXPECT_EQ(make_plan(space, {}, {}, true, test_profile()).cache_bytes, 0u);
}

TEST(Plan, DiscreteAxesAreNotFetchedAhead) {
  const ParameterSpace space = make_space({{AxisKind::kDiscrete, 16}});
  const EncodedField field = make_encoded(space, 1, 8, 0, [](int) { return 5000u; });
  const Plan plan = make_plan(space, {0.25f}, {{1, &field, 16, 16}}, true, test_profile(10'000));
  EXPECT_EQ(plan.cache_bytes, (2 + 3) * 6u * 256);  // two tops, one node on each further level
  EXPECT_EQ(plan.settle_frames, 3u);                // 15 000 units, 5000 of each frame may go to a tile
}

TEST(Plan, TheFirstFrameUploadsTheTextureOfEveryField) {
  const ParameterSpace space = make_space({{AxisKind::kLinear, 4}});
  const EncodedField moving = make_encoded(space, 1, 4, 0, [](int) { return 1u; });
  const EncodedField still = make_encoded(space, 0, 1, 0, [](int) { return 1u; });
  const uint64_t large = 8 * (64 + 16 + 4 + 1), small = 8 * (8 + 2 + 1);  // 8 x 8 and 4 x 2 with their levels
  const PlannedField a{1, &moving, 8, 8}, b{1, &moving, 4, 2}, c{0, &still, 8, 8};
  EXPECT_EQ(make_plan(space, {0.1f}, {a}, true, test_profile()).upload_worst, large);
  EXPECT_EQ(make_plan(space, {0.1f}, {a, b, c}, true, test_profile()).upload_worst, 2 * large + small);
}

TEST(Plan, AllZeroNodesCostNothing) {
  const ParameterSpace space = make_space({{AxisKind::kLinear, 32}});
  const EncodedField field = make_encoded(space, 1, 8, 0, [](int) { return 0u; });
  const Plan plan = make_plan(space, {0.25f}, {{1, &field, 64, 64}}, true, test_profile());
  EXPECT_EQ(plan.units_worst, 0u);
  EXPECT_EQ(plan.cache_bytes, 0u);
}

TEST(Plan, MoreSpeedNeverNeedsLess) {
  const ParameterSpace space = make_space({{AxisKind::kLinear, 64}, {AxisKind::kPeriodic, 8}});
  std::mt19937 random(1);
  const EncodedField field = make_encoded(space, 3, 8, 3, [&](int) { return 1 + static_cast<uint32_t>(random() % 9000); });
  uint64_t before = 0;
  for (const float speed : {0.05f, 0.1f, 0.25f, 0.5f, 1.0f, 2.0f}) {
    const AnchorLattice anchors(space, {speed, speed}, true);
    const uint64_t units = worst_sustained_units(anchors, find_demand(anchors, {{3, &field, 32, 32}}, 1), 1);
    EXPECT_GE(units, before) << speed;
    before = units;
  }
}

TEST(Plan, ATightBudgetLengthensTheHorizonAndATightCacheForbidsIt) {
  const ParameterSpace space = make_space({{AxisKind::kLinear, 64}});
  const EncodedField field = make_encoded(space, 1, 8, 0, [](int) { return 40'000u; });
  const std::vector<PlannedField> fields{{1, &field, 64, 64}};
  const Plan easy = make_plan(space, {0.25f}, fields, false, test_profile(1'000'000));
  const AnchorLattice anchors(space, {0.25f}, false);
  const auto sustained = [&](int horizon) {
    return worst_sustained_units(anchors, find_demand(anchors, fields, horizon), horizon);
  };
  const uint64_t tile = easy.units_worst - sustained(1);
  const Plan tight = make_plan(space, {0.25f}, fields, false, test_profile(sustained(8) + tile));
  EXPECT_EQ(tight.horizon_frames, 8u);
  EXPECT_LE(tight.units_worst, tight.units_budget);
  EXPECT_GT(tight.cache_bytes, easy.cache_bytes);
  EXPECT_TRUE(misfits(tight, test_profile(tight.units_budget)).empty());
  const Profile small = test_profile(tight.units_budget, easy.cache_bytes);
  const Plan poor = make_plan(space, {0.25f}, fields, false, small);
  EXPECT_EQ(poor.cache_bytes, easy.cache_bytes);
  ASSERT_EQ(misfits(poor, small).size(), 1u);
  EXPECT_NE(misfits(poor, small)[0].find("decoding units"), std::string::npos);
}

// ---- against a direct count over nodes ----

// What plan.md says, node by node.
struct DirectCount {
  const AnchorLattice& anchors;
  const std::vector<PlannedField>& fields;
  int horizon;

  bool meets(const PlannedField& field, int node, const GridIndex& cell, int reach_of_horizon) const {
    const FieldShape::Box box = field.encoded->shape.samples_of(node);
    if (field.encoded->node_bytes[static_cast<size_t>(node)] == 0 || field.encoded->shape.level_of(node) == 0) return false;
    for (int a = 0; a < anchors.axis_count(); ++a) {
      if (!(field.axes >> a & 1)) continue;
      const int reach = reach_of_horizon < 0 ? 0 : anchors.reach(a, reach_of_horizon);
      const IntervalSet samples = anchors.samples(a, cell[a], reach);
      bool any = false;
      for (int s = box.first[a]; s <= box.last[a]; ++s)
        for (int i = 0; i < samples.count; ++i) any = any || (s >= samples.parts[i].first && s <= samples.parts[i].last);
      if (!any) return false;
    }
    return true;
  }

  uint64_t resident_nodes(const GridIndex& cell, int reach) const { return sum(cell, nullptr, reach).second; }
  uint64_t displayed_units(const GridIndex& cell) const { return sum(cell, nullptr, -1).first; }
  uint64_t entering_units(const GridIndex& from, const GridIndex& to) const { return sum(to, &from, horizon).first; }

  std::pair<uint64_t, uint64_t> sum(const GridIndex& cell, const GridIndex* before, int reach) const {
    uint64_t units = 0, count = 0;
    for (const PlannedField& field : fields)
      for (int node = 0; node < field.encoded->shape.node_count(); ++node) {
        if (!meets(field, node, cell, reach) || (before && meets(field, node, *before, reach))) continue;
        units += field.encoded->node_units[static_cast<size_t>(node)];
        ++count;
      }
    return {units, count};
  }
};

TEST(Demand, IsWhatCountingNodeByNodeSays) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 25; ++trial) {
    ParameterSpace space;
    space.axis_count = 1 + trial % 3;
    std::vector<float> speeds;
    for (int a = 0; a < space.axis_count; ++a) {
      space.axes[a] = {static_cast<AxisKind>(random() % 3), 1 + static_cast<int>(random() % (a == 0 ? 12 : 5))};
      speeds.push_back(0.1f * static_cast<float>(1 + random() % 12));
    }
    std::vector<std::unique_ptr<EncodedField>> encoded;
    std::vector<PlannedField> fields;
    for (int f = 0; f < 3; ++f) {
      const AxisMask axes = random() % (1u << space.axis_count);
      const int block = 1 << random() % 4;
      encoded.push_back(std::make_unique<EncodedField>(make_encoded(space, axes, block,
                                                                    static_cast<int>(random() % static_cast<unsigned>(block)),
                                                                    [&](int) { return static_cast<uint32_t>(random() % 100); })));
      fields.push_back({axes, encoded.back().get(), 8, 8});
    }
    const int horizon = 1 + static_cast<int>(random() % 4);
    const AnchorLattice anchors(space, speeds, trial % 2 == 0);
    const Demand demand = find_demand(anchors, fields, horizon);
    const DirectCount direct{anchors, fields, horizon};
    ASSERT_EQ(demand.pools.size(), 1u);
    for (int64_t flat = 0; flat < anchors.cell_count(); ++flat) {
      GridIndex cell{};
      int64_t rest = flat;
      for (int a = space.axis_count - 1; a >= 0; --a) {
        cell[a] = static_cast<int>(rest % anchors.cells(a));
        rest /= anchors.cells(a);
      }
      const size_t at = static_cast<size_t>(flat);
      ASSERT_EQ(demand.displayed_units[at], direct.displayed_units(cell));
      ASSERT_EQ(demand.pools[0].resident_nodes[at], direct.resident_nodes(cell, horizon));
      for (int number = 0; number < step_count(space.axis_count); ++number) {
        const AnchorStep step = step_from_number(number, space.axis_count);
        ASSERT_EQ(step_number(step, space.axis_count), number);
        GridIndex to = cell;
        bool legal = true;
        for (int a = 0; a < space.axis_count; ++a) {
          to[a] += step[a];
          if (anchors.wraps(a)) to[a] = (to[a] + anchors.cells(a)) % anchors.cells(a);
          legal = legal && to[a] >= 0 && to[a] < anchors.cells(a) && (step[a] == 0 || anchors.moves(a));
        }
        if (legal) {
          ASSERT_EQ(demand.entering_units[at * static_cast<size_t>(step_count(space.axis_count)) + static_cast<size_t>(number)],
                    direct.entering_units(cell, to));
        }
      }
    }
  }
}

TEST(Sustained, IsTheLeastThatServesEveryWindow) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<uint64_t> entering(1 + random() % 40);
    for (uint64_t& e : entering) e = random() % 3 == 0 ? random() % 1000 : 0;
    const int horizon = 1 + static_cast<int>(random() % 10);
    uint64_t expected = 0;
    for (size_t from = 0; from < entering.size(); ++from) {
      uint64_t sum = 0;
      for (size_t to = from; to < entering.size(); ++to) {
        sum += entering[to];
        const uint64_t frames = to - from + 1 + static_cast<uint64_t>(horizon);
        expected = std::max(expected, (sum + frames - 1) / frames);
      }
    }
    ASSERT_EQ(least_sustained_units(entering, horizon, 0), expected);
    ASSERT_EQ(least_sustained_units(entering, horizon, expected + 5), expected + 5);
  }
}

// A node that enters when a hand at top speed comes to a cell is not shown for `horizon` frames.
TEST(Anchors, WhatEntersHasTheHorizonsFramesLeft) {
  for (const bool interpolate : {false, true})
    for (const AxisKind kind : {AxisKind::kLinear, AxisKind::kPeriodic})
      for (const double speed : {0.1, 0.25, 0.7, 1.0, 1.6})
        for (const int horizon : {1, 2, 5}) {
          const ParameterSpace space = make_space({{kind, 40}});
          const AnchorLattice anchors(space, {static_cast<float>(speed)}, interpolate);
          const int reach = anchors.reach(0, horizon);
          // From the lower border of cell 10, moving up: the first sample beyond what was resident in it.
          const double border = interpolate ? 10 : 9.5;
          const int beyond = 10 + (interpolate ? 1 : 0) + reach;  // entered with this cell
          const double shown_from = interpolate ? beyond - 1 : beyond - 0.5;
          EXPECT_GE((shown_from - border) / speed, horizon - 1e-6);
          // And one that is not resident while in the cell cannot be shown within the horizon of leaving it.
          EXPECT_GE((shown_from + 1 - (border + 1)) / speed, horizon - 1e-6);
        }
}

TEST(Anchors, WindowsWrapOnPeriodicAxesOnly) {
  const AnchorLattice periodic(make_space({{AxisKind::kPeriodic, 8}}), {1.0f}, false);
  EXPECT_EQ(periodic.samples(0, 0, 2).size(), 5);
  EXPECT_EQ(periodic.samples(0, 7, 2).size(), 5);
  EXPECT_EQ(periodic.samples(0, 3, 5).size(), 8);
  const AnchorLattice linear(make_space({{AxisKind::kLinear, 8}}), {1.0f}, false);
  EXPECT_EQ(linear.samples(0, 0, 2).size(), 3);
  EXPECT_EQ(linear.samples(0, 7, 2).size(), 3);
}

TEST(Plan, ALargeSpaceOfManyFieldsIsPlannedInSeconds) {
  const ParameterSpace space = make_space({{AxisKind::kLinear, 64}, {AxisKind::kLinear, 8}, {AxisKind::kPeriodic, 8}});
  std::vector<std::unique_ptr<EncodedField>> encoded;
  std::vector<PlannedField> fields;
  for (int f = 0; f < 20; ++f) {
    const AxisMask axes = f % 2 == 0 ? 6 : 7;
    encoded.push_back(std::make_unique<EncodedField>(
        make_encoded(space, axes, 8, f % 8, [&](int node) { return 1000 + static_cast<uint32_t>(node) % 4096; })));
    fields.push_back({axes, encoded.back().get(), 128, 128});
  }
  const auto begin = std::chrono::steady_clock::now();
  const Plan plan =
      make_plan(space, {0.25f, 0.1f, 0.1f}, fields, true, test_profile(1'000));  // no horizon suffices: all are tried
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  RecordProperty("seconds", std::to_string(seconds));
  std::printf("planned in %.2f s: horizon %u, units_worst %llu\n", seconds, plan.horizon_frames,
              static_cast<unsigned long long>(plan.units_worst));
  EXPECT_GT(plan.units_worst, 0u);
}

}  // namespace
}  // namespace vitrine
