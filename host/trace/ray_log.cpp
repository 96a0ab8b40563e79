// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/ray_log.h"

#include <algorithm>

#include "host/trace/ray_filter.h"
#include "host/trace/world.h"

namespace vitrine::trace {

size_t RayLog::shadows() const {
  return static_cast<size_t>(std::count_if(queries_.begin(), queries_.end(), [](const Query& q) { return q.shadow; }));
}

size_t RayLog::replay(const World& world) const {
  size_t hits = 0;
  for (const Query& q : queries_) {
    if (q.shadow) {
      ShadowContext context(q.through_glass);
      RTCRay ray = q.ray;
      rtcOccluded1(world.embree_scene(), &context.embree, &ray);
      hits += ray.tfar < 0;
    } else {
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      RTCRayHit query;
      query.ray = q.ray;
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(world.embree_scene(), &context, &query);
      hits += query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
  }
  return hits;
}

}  // namespace vitrine::trace
