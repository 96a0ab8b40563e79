// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/scheduler.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace vitrine {
namespace {

constexpr uint64_t kUnlimited = std::numeric_limits<uint64_t>::max();

bool is_ready(const FieldState& field, const NodePool& pool, uint32_t node) {
  const int32_t where = field.slot[node];
  return where == kAllZero || where == kDamaged || (where >= 0 && pool.ready[static_cast<size_t>(where)]);
}

// What a step of a decoder costs is known only when it is done. The costliest so far stands for the next; to begin with, twice
// what a full tile of the dearest node costs if its cost is spread evenly.
uint64_t first_step_guess(std::span<const FieldState> fields) {
  uint64_t guess = 1;
  for (const FieldState& field : fields)
    for (const uint64_t units : *field.field->node_units())
      guess = std::max(guess, std::min<uint64_t>(units, 2 * units * kTileSize * kTileSize / field.texels()));
  return guess;
}

}  // namespace

void Scheduler::lay_out(std::span<const FieldState> fields, uint64_t units_budget, Arena& arena) {
  units_budget_ = units_budget;
  largest_step_ = first_step_guess(fields);
  uint64_t jobs = 0;
  size_t cells = 1;
  for (const FieldState& field : fields) {
    for (size_t l = 0; l < kMaxLevels; ++l) jobs += std::min(field.window_nodes[l], field.coded_nodes[l]);
    jobs = std::max(jobs, field.coded_nodes[0]);
    cells = std::max(cells, most_cells(field));
  }
  jobs_ = arena.take<Job>(jobs);
  works_ = arena.take<Work>(kNodesInDecoding);  // more than deadlines that differ among urgent nodes; about 9 KB each
  take_scratch(fields, arena);
  for (auto& of_axis : cells_) of_axis = arena.take<WantedCell>(cells);
}

// Each piece of work may be on a node of any field.
void Scheduler::take_scratch(std::span<const FieldState> fields, Arena& arena) {
  size_t words = 0;
  for (const FieldState& field : fields)
    if (field.coder() == NodeCoder::kSpiht) words = std::max(words, spiht_scratch_words(field.width, field.height));
  const std::span<uint16_t> all = arena.take_uninitialized<uint16_t>(kNodesInDecoding * words);
  for (size_t w = 0; w < works_.size(); ++w)
    if (!all.empty()) works_[w].scratch = all.subspan(w * words, words);
}

bool Scheduler::later(const Job& a, const Job& b) {
  return std::tie(a.frames, a.level, a.field, a.node) > std::tie(b.frames, b.level, b.field, b.node);
}

void Scheduler::add_job(const FieldState& field, const NodePool& pool, uint32_t index, uint32_t node, uint32_t level,
                        uint32_t frames) {
  if (!is_ready(field, pool, node) && job_count_ < jobs_.size()) jobs_[job_count_++] = {frames, level, index, node};
}

// Every combination of wanted cells along the axes.
void Scheduler::gather_level(const FieldState& field, const NodePool& pool, uint32_t index, int level,
                             const std::array<size_t, kMaxAxes>& counts) {
  const auto axes = static_cast<size_t>(field.shape.space.axis_count);
  if (std::any_of(counts.begin(), counts.begin() + static_cast<ptrdiff_t>(axes), [](size_t n) { return n == 0; })) return;
  std::array<size_t, kMaxAxes> at{};
  for (;;) {
    int node = field.first_in_block[static_cast<size_t>(level)];
    uint32_t frames = 0;
    for (size_t a = 0; a < axes; ++a) {
      node += cells_[a][at[a]].node_offset;
      frames = std::max(frames, cells_[a][at[a]].frames);
    }
    add_job(field, pool, index, static_cast<uint32_t>(node), static_cast<uint32_t>(level), frames);
    size_t a = 0;
    while (a < axes && ++at[a] == counts[a]) at[a++] = 0;
    if (a == axes) return;
  }
}

void Scheduler::gather_field(const FieldState& field, const NodeCache& cache, const Viewpoint& viewpoint, uint32_t index) {
  for (int level = 1; level < field.shape.pyramid.level_count; ++level) {  // the tops are there
    std::array<size_t, kMaxAxes> counts{};
    for (int a = 0; a < field.shape.space.axis_count; ++a)
      counts[static_cast<size_t>(a)] = wanted_cells(
          field, *viewpoint.motion, level, a, viewpoint.of_field[index][static_cast<size_t>(a)], cells_[static_cast<size_t>(a)]);
    gather_level(field, cache.pool_of(field), index, level, counts);
  }
}

DecodeResult Scheduler::decode_tops(std::span<FieldState> fields, NodeCache& cache, const Viewpoint& viewpoint) {
  DecodeResult all;
  for (uint32_t f = 0; f < fields.size(); ++f) {
    const FieldState& field = fields[f];
    job_count_ = 0;
    const int tops = field.shape.pyramid.level_count > 1 ? field.first_in_block[1] : field.nodes_per_block;
    for (int block = 0; block < field.shape.block_count(); ++block)
      for (int top = 0; top < tops; ++top)
        add_job(field, cache.pool_of(field), f, static_cast<uint32_t>(block * field.nodes_per_block + top), 0, 0);
    std::make_heap(jobs_.begin(), jobs_.begin() + static_cast<ptrdiff_t>(job_count_), later);
    const DecodeResult result = run(fields, cache, viewpoint, kUnlimited);
    all.units += result.units;
    all.damaged += result.damaged;
  }
  return all;
}

DecodeResult Scheduler::decode_shown(std::span<FieldState> fields, NodeCache& cache, const Viewpoint& viewpoint) {
  job_count_ = 0;
  for (uint32_t f = 0; f < fields.size(); ++f)
    for (int i = 0; i < viewpoint.shown[f].count; ++i)
      for (int level = 0; level < fields[f].shape.pyramid.level_count; ++level) {
        const int node = fields[f].shape.node_of(viewpoint.shown[f].samples[static_cast<size_t>(i)].index, level);
        add_job(fields[f], cache.pool_of(fields[f]), f, static_cast<uint32_t>(node), static_cast<uint32_t>(level), 0);
      }
  std::make_heap(jobs_.begin(), jobs_.begin() + static_cast<ptrdiff_t>(job_count_), later);
  return run(fields, cache, viewpoint, kUnlimited);
}

DecodeResult Scheduler::decode_wanted(std::span<FieldState> fields, NodeCache& cache, const Viewpoint& viewpoint) {
  job_count_ = 0;
  for (uint32_t f = 0; f < fields.size(); ++f) gather_field(fields[f], cache, viewpoint, f);
  std::make_heap(jobs_.begin(), jobs_.begin() + static_cast<ptrdiff_t>(job_count_), later);
  return run(fields, cache, viewpoint, units_budget_);
}

DecodeResult Scheduler::run(std::span<FieldState> fields, NodeCache& cache, const Viewpoint& viewpoint, uint64_t budget) {
  cache.begin_frame();
  DecodeResult result;
  while (job_count_ > 0) {
    std::pop_heap(jobs_.begin(), jobs_.begin() + static_cast<ptrdiff_t>(job_count_), later);
    const Job job = jobs_[--job_count_];
    if (is_ready(fields[job.field], cache.pool_of(fields[job.field]), job.node)) continue;  // gathered twice
    if (run_job(fields, cache, viewpoint, job, budget, result) == Outcome::kOutOfUnits) break;
  }
  return result;
}

// No step can cost more than what the node has left, but for the least that each further one costs.
uint64_t Scheduler::next_step_bound(const Work& work) const {
  const uint64_t others = kUnitsPerTile * static_cast<uint64_t>(std::max(work.steps_left - 1, 0));
  return std::min(largest_step_, work.units_left > others ? work.units_left - others : 1);
}

Scheduler::Outcome Scheduler::run_job(std::span<FieldState> fields, NodeCache& cache, const Viewpoint& viewpoint, const Job& job,
                                      uint64_t budget, DecodeResult& result) {
  Work* work = find_work(fields, cache, viewpoint, job);
  if (!work) return result.damaged += fields[job.field].slot[job.node] == kDamaged, Outcome::kNoRoom;
  while (!work->decoder.done()) {
    // At least one tile a frame, so that a budget below any tile does not stop everything for ever.
    if (result.units > 0 && next_step_bound(*work) > budget - std::min(budget, result.units)) return Outcome::kOutOfUnits;
    const Result<uint64_t> step = work->decoder.step(1);
    if (!step.ok()) {
      cache.release(fields, job.field, job.node, kDamaged);
      work->used = false;
      ++result.damaged;
      return Outcome::kDone;
    }
    result.units += step.value();
    work->units_left -= std::min(work->units_left, step.value());
    --work->steps_left;
    largest_step_ = std::max(largest_step_, step.value());
  }
  cache.pool_of(fields[job.field]).ready[static_cast<size_t>(work->slot)] = 1;
  work->used = false;
  return Outcome::kDone;
}

// The work that was begun on the node, or new work in a slot of its own.
Scheduler::Work* Scheduler::find_work(std::span<FieldState> fields, NodeCache& cache, const Viewpoint& viewpoint,
                                      const Job& job) {
  FieldState& field = fields[job.field];
  for (Work& work : works_)
    if (work.used && work.field == job.field && work.node == job.node) return work.frames = job.frames, &work;
  const int32_t slot = cache.acquire(fields, viewpoint, job.field, job.node, job.frames, job.level == 0);
  if (slot == kNotResident) return nullptr;
  drop_evicted_work(fields);
  Work& work = free_work(fields, cache);
  const NodeDesc desc = field.desc_of(job.node);
  // A description that the decoder refuses leaves it done, and the first look at it finds the node damaged.
  const Status started =
      work.decoder.start(field.coder(), desc, field.bytes_of(job.node), cache.pool_of(field).planes_of(slot), work.scratch);
  if (!started.ok()) return cache.release(fields, job.field, job.node, kDamaged), nullptr;
  work.field = job.field;
  work.node = job.node;
  work.frames = job.frames;
  work.slot = slot;
  work.units_left = desc.units;
  work.steps_left = field.step_count();
  work.used = true;
  return &work;
}

// Work whose slot was given to another node.
void Scheduler::drop_evicted_work(std::span<const FieldState> fields) {
  for (Work& work : works_)
    if (work.used && fields[work.field].slot[work.node] != work.slot) work.used = false;
}

// Where all are taken, the one that is needed last begins anew when its turn comes.
Scheduler::Work& Scheduler::free_work(std::span<FieldState> fields, NodeCache& cache) {
  Work* last = &works_[0];
  for (Work& work : works_) {
    if (!work.used) return work;
    if (work.frames > last->frames) last = &work;
  }
  cache.release(fields, last->field, last->node, kNotResident);
  last->used = false;
  return *last;
}

}  // namespace vitrine
