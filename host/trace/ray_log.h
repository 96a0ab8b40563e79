// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The queries that a render made of Embree, in their order, to be made again by nothing but a loop: what tracing them costs
// without all that the tracer does between them.
#pragma once

#include <embree3/rtcore.h>

#include <vector>

namespace vitrine::trace {

class World;

class RayLog {
 public:
  void add_intersection(const RTCRay& ray) { queries_.push_back({ray, false, false}); }
  void add_shadow(const RTCRay& ray, bool through_glass) { queries_.push_back({ray, true, through_glass}); }
  size_t size() const { return queries_.size(); }
  size_t shadows() const;
  // Asks them all again of the world that they were asked of, posed as then; the number of hits.
  size_t replay(const World& world) const;

 private:
  struct Query {
    RTCRay ray;
    bool shadow, through_glass;
  };
  std::vector<Query> queries_;
};

}  // namespace vitrine::trace
