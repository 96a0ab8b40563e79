// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Which nodes are decoded, and in which order: by earliest deadline, coarse levels before fine ones, a tile at a time within
// the units of the frame. A node whose turn is over before it is done goes on in a later frame.
#pragma once

#include <cstdint>
#include <span>

#include "target/arena.h"
#include "target/decode/any_node_decoder.h"
#include "target/field_state.h"
#include "target/node_cache.h"

namespace vitrine {

struct DecodeResult {
  uint64_t units = 0;
  int64_t damaged = 0;  // nodes given up
};

class Scheduler {
 public:
  void lay_out(std::span<const FieldState> fields, uint64_t units_budget, Arena& arena);

  // Decodes the tops of all pyramids, whatever it costs.
  DecodeResult decode_tops(std::span<FieldState> fields, NodeCache& cache, const Viewpoint& viewpoint);
  // Decodes all that is shown, whatever it costs (tops too).
  DecodeResult decode_shown(std::span<FieldState> fields, NodeCache& cache, const Viewpoint& viewpoint);
  // Decodes what is wanted, within the budget.
  DecodeResult decode_wanted(std::span<FieldState> fields, NodeCache& cache, const Viewpoint& viewpoint);

 private:
  struct Job {
    uint32_t frames = 0, level = 0, field = 0, node = 0;
  };
  // A node that is being decoded.
  struct Work {
    AnyNodeDecoder decoder;
    std::span<uint16_t> scratch;
    uint32_t field = 0, node = 0, frames = 0;
    int32_t slot = kNotResident;
    uint64_t units_left = 0;
    int steps_left = 0;  // at least
    bool used = false;
  };
  enum class Outcome { kDone, kOutOfUnits, kNoRoom };

  void take_scratch(std::span<const FieldState> fields, Arena& arena);
  static bool later(const Job& a, const Job& b);
  void gather_field(const FieldState& field, const NodeCache& cache, const Viewpoint& viewpoint, uint32_t index);
  void gather_level(const FieldState& field, const NodePool& pool, uint32_t index, int level,
                    const std::array<size_t, kMaxAxes>& counts);
  void add_job(const FieldState& field, const NodePool& pool, uint32_t index, uint32_t node, uint32_t level, uint32_t frames);
  DecodeResult run(std::span<FieldState> fields, NodeCache& cache, const Viewpoint& viewpoint, uint64_t budget);
  Outcome run_job(std::span<FieldState> fields, NodeCache& cache, const Viewpoint& viewpoint, const Job& job, uint64_t budget,
                  DecodeResult& result);
  Work* find_work(std::span<FieldState> fields, NodeCache& cache, const Viewpoint& viewpoint, const Job& job);
  Work& free_work(std::span<FieldState> fields, NodeCache& cache);
  void drop_evicted_work(std::span<const FieldState> fields);
  uint64_t next_step_bound(const Work& work) const;

  uint64_t units_budget_ = 0, largest_step_ = 0;
  std::span<Job> jobs_;  // a heap, the most urgent on top
  size_t job_count_ = 0;
  std::span<Work> works_;
  std::array<std::span<WantedCell>, kMaxAxes> cells_;
};

}  // namespace vitrine
