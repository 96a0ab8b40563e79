// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The state of one path between two vertices.
#pragma once

#include <array>

#include "host/trace/light_tree.h"
#include "host/trace/world.h"

namespace vitrine::trace {

// The solids that a path is inside of, innermost last. Deeper nesting than the array forgets the outermost.
class Media {
 public:
  void enter(int object, const glm::vec3& absorption) {
    if (count_ == kCapacity) remove_at(0);
    entries_[static_cast<size_t>(count_++)] = {object, absorption};
  }
  void leave(int object) {
    for (int i = count_ - 1; i >= 0; --i) {
      if (entries_[static_cast<size_t>(i)].object == object) return remove_at(i);
    }
  }
  bool empty() const { return count_ == 0; }
  glm::vec3 absorption() const { return count_ ? entries_[static_cast<size_t>(count_ - 1)].absorption : glm::vec3(0); }

 private:
  static constexpr int kCapacity = 4;
  struct Entry {
    int object = -1;
    glm::vec3 absorption{0};
  };
  void remove_at(int index) {
    for (int i = index; i + 1 < count_; ++i) entries_[static_cast<size_t>(i)] = entries_[static_cast<size_t>(i + 1)];
    --count_;
  }
  std::array<Entry, kCapacity> entries_;
  int count_ = 0;
};

struct Path {
  Ray ray;
  glm::vec3 throughput{1};
  float radiance_scale = 1;  // product of the squared indices crossed: what refraction took from radiance but not from power
  float travelled = 0;       // since the last vertex that scattered
  uint32_t stream = 0, vertex = 1;  // where its random numbers come from
  int scatterings = 0;

  // Light that the next segment finds may already have been counted by sampling lights.
  bool lights_sampled = false;      // at the last vertex, towards where the ray goes
  float pdf = 0;                    // of the ray's direction then
  LightReceiver receiver;           // what they were sampled for
  glm::vec3 share{1};               // of light that is found now, the part that no vertex before has counted
  glm::vec3 share_behind_glass{1};  // what the next refraction multiplies `share` by
  bool in_sight = true;             // nothing but holes and panes lies between the camera and here, in a straight line
  bool seen = true;                 // nothing but mirrors and clear glass lies between the camera and here
  Media media;
};

}  // namespace vitrine::trace
