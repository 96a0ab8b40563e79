// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "target/node_cache.h"

#include <algorithm>

namespace vitrine {
namespace {

constexpr uint32_t kNoField = 0xffffffffu;

bool nearer(const NodePool::Candidate& a, const NodePool::Candidate& b) {
  return a.frames != b.frames ? a.frames < b.frames : a.slot < b.slot;
}

// Pinned tops in any case; then what is shown at once at least, and all that is ever wanted at most.
void count_slots(const FieldState& field, NodePool& pool) {
  for (int level = 0; level < field.shape.pyramid.level_count; ++level) {
    const auto l = static_cast<size_t>(level);
    const uint64_t coded = field.coded_nodes[l];
    const uint64_t least = level == 0 ? coded : std::min<uint64_t>(coded, static_cast<uint64_t>(field.corner_count));
    pool.least_slots += least;
    pool.most_slots += level == 0 ? coded : std::max(least, std::min(coded, field.window_nodes[l]));
  }
}

void take_slots(NodePool& pool, Arena& arena) {
  pool.planes = arena.take_uninitialized<int16_t>(pool.slot_count * pool.slot_values());
  pool.owner_field = arena.take<uint32_t>(pool.slot_count);
  pool.owner_node = arena.take<uint32_t>(pool.slot_count);
  pool.ready = arena.take<uint8_t>(pool.slot_count);
  pool.pinned = arena.take<uint8_t>(pool.slot_count);
  pool.free = arena.take<uint32_t>(pool.slot_count);
  pool.candidates = arena.take<NodePool::Candidate>(pool.slot_count);
  std::fill(pool.owner_field.begin(), pool.owner_field.end(), kNoField);
  for (size_t i = 0; i < pool.free.size(); ++i) pool.free[i] = static_cast<uint32_t>(pool.free.size() - 1 - i);
  pool.free_count = pool.free.size();
}

void rank_candidates(NodePool& pool, std::span<const FieldState> fields, const Viewpoint& viewpoint) {
  pool.candidate_count = 0;
  for (uint32_t slot = 0; slot < pool.slot_count; ++slot) {
    const uint32_t f = pool.owner_field[slot];
    if (f == kNoField || pool.pinned[slot]) continue;
    const uint32_t node = pool.owner_node[slot];
    const uint32_t frames = frames_until(fields[f].shape, *viewpoint.motion, viewpoint.of_field[f], static_cast<int>(node));
    // On the very border of its box a node is due and not shown: it may go for one that is.
    if (frames > 0 || !fields[f].shows(viewpoint.shown[f], node))
      pool.candidates[pool.candidate_count++] = {std::max(frames, 1u), slot};
  }
  std::make_heap(pool.candidates.begin(), pool.candidates.begin() + static_cast<ptrdiff_t>(pool.candidate_count), nearer);
  pool.candidates_known = true;
}

// Takes the slot of the node that is farthest, where that is farther than `frames`.
int32_t evict(NodePool& pool, std::span<FieldState> fields, const Viewpoint& viewpoint, uint32_t frames) {
  if (!pool.candidates_known) rank_candidates(pool, fields, viewpoint);
  if (pool.candidate_count == 0 || pool.candidates[0].frames <= frames) return kNotResident;
  std::pop_heap(pool.candidates.begin(), pool.candidates.begin() + static_cast<ptrdiff_t>(pool.candidate_count), nearer);
  const uint32_t slot = pool.candidates[--pool.candidate_count].slot;
  const uint32_t owner = pool.owner_field[slot];
  if (owner == kNoField) return kNotResident;  // released since; it is in the free list and was tried before
  fields[owner].slot[pool.owner_node[slot]] = kNotResident;
  return static_cast<int32_t>(slot);
}

}  // namespace

void NodeCache::assign_pools(std::span<FieldState> fields) {
  for (FieldState& field : fields) {
    const auto same = [&](const NodePool& pool) { return pool.width == field.width && pool.height == field.height; };
    auto pool = std::find_if(pools_.begin(), pools_.end(), same);
    if (pool == pools_.end()) {
      pools_.push_back({.width = field.width, .height = field.height});
      pool = pools_.end() - 1;
    }
    field.pool = static_cast<uint32_t>(pool - pools_.begin());
    count_slots(field, *pool);
  }
}

void NodeCache::lay_out(std::span<FieldState> fields, uint64_t cache_bytes, Arena& arena) {
  assign_pools(fields);
  double least = 0, most = 0;
  for (const NodePool& pool : pools_) {
    least += static_cast<double>(pool.least_slots) * static_cast<double>(pool.slot_bytes());
    most += static_cast<double>(pool.most_slots) * static_cast<double>(pool.slot_bytes());
  }
  const double share = most > least ? std::clamp((static_cast<double>(cache_bytes) - least) / (most - least), 0.0, 1.0) : 0.0;
  for (NodePool& pool : pools_) {
    pool.slot_count = pool.least_slots + static_cast<uint64_t>(share * static_cast<double>(pool.most_slots - pool.least_slots));
    bytes_ += pool.slot_count * pool.slot_bytes();
    take_slots(pool, arena);
  }
}

void NodeCache::begin_frame() {
  for (NodePool& pool : pools_) pool.candidates_known = false;
}

int32_t NodeCache::acquire(std::span<FieldState> fields, const Viewpoint& viewpoint, uint32_t field, uint32_t node,
                           uint32_t frames, bool pin) {
  NodePool& pool = pools_[fields[field].pool];
  const int32_t slot =
      pool.free_count > 0 ? static_cast<int32_t>(pool.free[--pool.free_count]) : evict(pool, fields, viewpoint, frames);
  if (slot < 0) return kNotResident;
  const auto s = static_cast<size_t>(slot);
  pool.owner_field[s] = field;
  pool.owner_node[s] = node;
  pool.ready[s] = 0;
  pool.pinned[s] = pin;
  fields[field].slot[node] = slot;
  return slot;
}

void NodeCache::release(std::span<FieldState> fields, uint32_t field, uint32_t node, int32_t leaves) {
  int32_t& where = fields[field].slot[node];
  if (where >= 0) {
    NodePool& pool = pools_[fields[field].pool];
    pool.owner_field[static_cast<size_t>(where)] = kNoField;
    pool.ready[static_cast<size_t>(where)] = 0;
    pool.free[pool.free_count++] = static_cast<uint32_t>(where);
  }
  where = leaves;
}

}  // namespace vitrine
