// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/plan/demand.h"

#include <algorithm>

#include "host/plan/level_costs.h"

namespace vitrine {
namespace {

// A field's demand over the cells of its own axes (the others have one cell).
class FieldDemand {
 public:
  FieldDemand(const AnchorLattice& anchors, const PlannedField& field, int horizon) : anchors_(anchors), field_(field) {
    const EncodedField& encoded = *field.encoded;
    for (int level = 1; level < encoded.shape.pyramid.level_count; ++level) add_level(LevelCosts(encoded, level), horizon);
  }

  uint64_t displayed_units(size_t cell) const { return displayed_units_[cell]; }
  uint64_t resident_nodes(size_t cell) const { return resident_nodes_[cell]; }
  uint64_t entering_units(size_t cell, size_t step) const { return entering_units_[cell * steps() + step]; }
  size_t cell_count() const {
    size_t count = 1;
    for (int a = 0; a < axis_count(); ++a) count *= static_cast<size_t>(cells(a));
    return count;
  }
  bool empty() const { return displayed_units_.empty(); }
  bool depends_on(int axis) const { return (field_.axes >> axis & 1) != 0; }
  int cells(int axis) const { return depends_on(axis) ? anchors_.cells(axis) : 1; }
  size_t steps() const { return static_cast<size_t>(step_count(axis_count())); }

 private:
  int axis_count() const { return anchors_.axis_count(); }

  // Rows of nodes per axis and cell: displayed, resident, and resident both here and one cell further on.
  struct AxisRows {
    std::vector<IntervalSet> displayed, resident, kept;
  };

  AxisRows rows_along(const LevelCosts& costs, int axis, int horizon) const {
    AxisRows rows;
    IntervalSet only;
    only.add(0, 0);
    for (int c = 0; c < cells(axis); ++c) {
      const auto at = [&](int reach) { return costs.rows_of(axis, depends_on(axis) ? anchors_.samples(axis, c, reach) : only); };
      rows.displayed.push_back(at(0));
      rows.resident.push_back(at(anchors_.reach(axis, horizon)));
    }
    for (int c = 0; c < cells(axis); ++c)
      rows.kept.push_back(
          intersection(rows.resident[static_cast<size_t>(c)], rows.resident[static_cast<size_t>((c + 1) % cells(axis))]));
    return rows;
  }

  void add_level(const LevelCosts& costs, int horizon) {
    std::array<AxisRows, kMaxAxes> rows;
    for (int a = 0; a < axis_count(); ++a) rows[a] = rows_along(costs, a, horizon);
    displayed_units_.resize(cell_count());
    resident_nodes_.resize(cell_count());
    entering_units_.resize(cell_count() * steps());
    std::vector<uint64_t> resident_units(cell_count());
    for (size_t cell = 0; cell < cell_count(); ++cell) {
      const GridIndex at = cell_index(cell);
      NodeRows displayed, resident;
      for (int a = 0; a < axis_count(); ++a) {
        displayed[a] = rows[a].displayed[static_cast<size_t>(at[a])];
        resident[a] = rows[a].resident[static_cast<size_t>(at[a])];
      }
      const NodeSum kept = costs.sum(resident);
      displayed_units_[cell] += costs.sum(displayed).units;
      resident_nodes_[cell] += kept.coded;
      resident_units[cell] = kept.units;
    }
    for (size_t cell = 0; cell < cell_count(); ++cell) add_steps(costs, rows, resident_units, cell);
  }

  // What enters is what is resident after the step less what was so before it. What stays is the same on the way back.
  void add_steps(const LevelCosts& costs, const std::array<AxisRows, kMaxAxes>& rows, const std::vector<uint64_t>& resident_units,
                 size_t cell) {
    const GridIndex at = cell_index(cell);
    for (size_t number = steps() / 2 + 1; number < steps(); ++number) {
      const AnchorStep step = step_from_number(static_cast<int>(number), axis_count());
      GridIndex to{};
      NodeRows kept;
      if (!take_step(at, step, to)) continue;
      for (int a = 0; a < axis_count(); ++a) {
        const AxisRows& axis = rows[a];
        kept[a] = step[a] == 0 ? axis.resident[static_cast<size_t>(at[a])]
                               : axis.kept[static_cast<size_t>(step[a] > 0 ? at[a] : to[a])];
      }
      const uint64_t stays = costs.sum(kept).units;
      const size_t there = flat_index(to), back = steps() - 1 - number;
      entering_units_[cell * steps() + number] += resident_units[there] - stays;
      entering_units_[there * steps() + back] += resident_units[cell] - stays;
    }
  }

  // False where the step leaves the space, is along an axis on which the field does not depend, or is none.
  bool take_step(const GridIndex& at, const AnchorStep& step, GridIndex& to) const {
    bool moved = false;
    for (int a = 0; a < axis_count(); ++a) {
      if (step[a] != 0 && (!depends_on(a) || !anchors_.moves(a))) return false;
      to[a] = at[a] + step[a];
      if (anchors_.wraps(a)) to[a] = (to[a] + cells(a)) % cells(a);
      if (to[a] < 0 || to[a] >= cells(a)) return false;
      moved = moved || step[a] != 0;
    }
    return moved;
  }

  GridIndex cell_index(size_t cell) const {
    GridIndex index{};
    for (int a = axis_count() - 1; a >= 0; --a) {
      index[a] = static_cast<int>(cell % static_cast<size_t>(cells(a)));
      cell /= static_cast<size_t>(cells(a));
    }
    return index;
  }
  size_t flat_index(const GridIndex& index) const {
    size_t flat = 0;
    for (int a = 0; a < axis_count(); ++a) flat = flat * static_cast<size_t>(cells(a)) + static_cast<size_t>(index[a]);
    return flat;
  }

  const AnchorLattice& anchors_;
  const PlannedField& field_;
  std::vector<uint64_t> displayed_units_, resident_nodes_, entering_units_;
};

PoolDemand& pool_of(Demand& demand, const PlannedField& field, size_t cells) {
  for (PoolDemand& pool : demand.pools)
    if (pool.width == field.width && pool.height == field.height) return pool;
  return demand.pools.emplace_back(PoolDemand{field.width, field.height, std::vector<uint64_t>(cells), 0});
}

// The field's own cell and step at a cell and step of the whole space.
struct Projection {
  std::vector<size_t> cell, step;
};

Projection project(const AnchorLattice& anchors, const FieldDemand& field) {
  const int axes = anchors.axis_count();
  Projection projection;
  for (int64_t cell = 0; cell < anchors.cell_count(); ++cell) {
    size_t own = 0, scale = 1;
    int64_t rest = cell;
    for (int a = axes - 1; a >= 0; --a) {
      if (field.depends_on(a)) own += static_cast<size_t>(rest % anchors.cells(a)) * scale;
      scale *= static_cast<size_t>(field.cells(a));
      rest /= anchors.cells(a);
    }
    projection.cell.push_back(own);
  }
  for (int number = 0; number < step_count(axes); ++number) {
    AnchorStep step = step_from_number(number, axes);
    for (int a = 0; a < axes; ++a)
      if (!field.depends_on(a)) step[a] = 0;
    projection.step.push_back(static_cast<size_t>(step_number(step, axes)));
  }
  return projection;
}

void add_field(const AnchorLattice& anchors, const FieldDemand& field, PoolDemand& pool, Demand& demand) {
  const Projection projection = project(anchors, field);
  const size_t steps = projection.step.size();
  for (size_t cell = 0; cell < projection.cell.size(); ++cell) {
    const size_t own = projection.cell[cell];
    demand.displayed_units[cell] += field.displayed_units(own);
    pool.resident_nodes[cell] += field.resident_nodes(own);
    for (size_t step = 0; step < steps; ++step)
      demand.entering_units[cell * steps + step] += field.entering_units(own, projection.step[step]);
  }
}

}  // namespace

uint64_t PoolDemand::worst_bytes() const {
  const uint64_t slot = uint64_t{3} * sizeof(int16_t) * static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
  return slot * (pinned_nodes + *std::max_element(resident_nodes.begin(), resident_nodes.end()));
}

int step_count(int axis_count) {
  int count = 1;
  for (int a = 0; a < axis_count; ++a) count *= 3;
  return count;
}

int step_number(const AnchorStep& step, int axis_count) {
  int number = 0;
  for (int a = 0; a < axis_count; ++a) number = number * 3 + step[a] + 1;
  return number;
}

AnchorStep step_from_number(int number, int axis_count) {
  AnchorStep step{};
  for (int a = axis_count - 1; a >= 0; --a) {
    step[a] = number % 3 - 1;
    number /= 3;
  }
  return step;
}

Demand find_demand(const AnchorLattice& anchors, const std::vector<PlannedField>& fields, int horizon) {
  const size_t cells = static_cast<size_t>(anchors.cell_count());
  Demand demand;
  demand.displayed_units.assign(cells, 0);
  demand.entering_units.assign(cells * static_cast<size_t>(step_count(anchors.axis_count())), 0);
  for (const PlannedField& field : fields) {
    PoolDemand& pool = pool_of(demand, field, cells);
    pool.pinned_nodes += LevelCosts(*field.encoded, 0).sum().coded;
    const FieldDemand own(anchors, field, horizon);
    if (!own.empty()) add_field(anchors, own, pool, demand);
  }
  return demand;
}

}  // namespace vitrine
