// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Decoded nodes in fixed slots. Nodes of one texture size share a pool; a pool never grows. What is farthest from being
// shown goes first; tops of pyramids are pinned, so that there is a coarse picture of everything, always.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "target/arena.h"
#include "target/field_state.h"

namespace vitrine {

struct NodePool {
  int width = 0, height = 0;
  uint64_t slot_count = 0, least_slots = 0, most_slots = 0;
  // Per slot.
  std::span<int16_t> planes;  // 3 * width * height each
  std::span<uint32_t> owner_field, owner_node;
  std::span<uint8_t> ready;  // decoded to the end
  std::span<uint8_t> pinned;
  // Slots without owner, the last ones first; and, from the first eviction of a frame on, all that may be evicted: a heap with
  // the farthest on top.
  struct Candidate {
    uint32_t frames = 0, slot = 0;
  };
  std::span<uint32_t> free;
  size_t free_count = 0;
  std::span<Candidate> candidates;
  size_t candidate_count = 0;
  bool candidates_known = false;

  size_t slot_values() const { return 3 * static_cast<size_t>(width) * static_cast<size_t>(height); }
  size_t slot_bytes() const { return sizeof(int16_t) * slot_values(); }
  std::span<int16_t> planes_of(int32_t slot) const {
    return planes.subspan(static_cast<size_t>(slot) * slot_values(), slot_values());
  }
};

// Where everything stands in the parameter space, for the question how far a node is.
struct Viewpoint {
  const Motion* motion = nullptr;
  std::span<const std::array<float, kMaxAxes>> of_field;  // coordinates in each field's own space
  std::span<const ShownField> shown;                      // of each field
};

class NodeCache {
 public:
  // Sorts the fields into pools by texture size and decides how many slots each gets: what is shown and pinned at least, what
  // can be wanted at most, and in between in proportion such that all fit `cache_bytes`.
  void lay_out(std::span<FieldState> fields, uint64_t cache_bytes, Arena& arena);
  uint64_t bytes() const { return bytes_; }

  void begin_frame();
  // A slot for a node that is needed in `frames`: a free one, or that of a node that is needed later. None: kNotResident.
  // Sets the node's FieldState::slot, and clears that of the one that had to go.
  int32_t acquire(std::span<FieldState> fields, const Viewpoint& viewpoint, uint32_t field, uint32_t node, uint32_t frames,
                  bool pin);
  void release(std::span<FieldState> fields, uint32_t field, uint32_t node,
               int32_t leaves);  // `leaves`: kNotResident or kDamaged

  NodePool& pool_of(const FieldState& field) { return pools_[field.pool]; }
  const NodePool& pool_of(const FieldState& field) const { return pools_[field.pool]; }

 private:
  void assign_pools(std::span<FieldState> fields);

  std::vector<NodePool> pools_;
  uint64_t bytes_ = 0;
};

}  // namespace vitrine
