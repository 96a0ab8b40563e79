// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Choice of one light among many by what it may give a point: its intensity, its distance and the directions that it and the
// point face. A bounding volume hierarchy over lights: Conty Estevez and Kulla, "Importance Sampling of Many Lights with
// Adaptive Tree Splitting", 2018; the bound of a node's importance is that of Pharr, Jakob and Humphreys, "Physically Based
// Rendering", 4th edition, 12.6.3.
//
// Nodes have four children side by side, so that one pass of vector arithmetic weighs them. Triangles that together fill the
// place that they take are not told apart by distance: a lamp, however finely it is tessellated, is one leaf. Alias tables
// choose within it, one for each octant of the directions that it may be seen from, so that its far side is not asked. A lamp
// alone costs no weighing at all.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/trace/alias_table.h"
#include "host/trace/vector_math.h"

namespace vitrine::trace {

// The point that light is wanted for.
struct LightReceiver {
  glm::vec3 position{0};
  glm::vec3 normal{0};  // unit: only light from its side counts; 0: light from everywhere does
};

// A lower bound of a cosine at the receiver, in importances: shading normals and glossy lobes may see more than the geometric
// normal says.
inline constexpr float kLeastReceivedCosine = 0.1f;

// What is known of a light before it is sampled.
struct LightBounds {
  glm::vec3 low{0}, high{0};  // box, metres
  glm::vec3 axis{0, 0, 1};    // unit, of the cone of its normals
  float cos_normals = 1;      // cosine of half that cone's angle: 1 for a flat light, -1 where normals point everywhere
  float cos_emission = 0;     // cosine of the greatest angle between a normal and a direction that light leaves in
  float intensity = 0;        // luminous, the greatest in any direction; > 0 and finite
  float area = 0;             // square metres; 0 for points
  bool double_sided = false;  // lights along the opposite normals, too
};

class LightTree {
 public:
  static constexpr int kWidth = 4;
  using Quad = float __attribute__((vector_size(4 * kWidth)));  // a vector register, by GCC and Clang on any machine

  // The tree as a receiver sees it: what all of its samples have in common.
  struct View {
    LightReceiver receiver;
    Quad root{};  // importances of the root's children, where there is more than one leaf
  };

  LightTree() = default;
  // Depends on nothing but the lights and their order.
  explicit LightTree(std::span<const LightBounds> lights);
  bool empty() const { return order_.empty(); }
  View view(const LightReceiver& receiver) const { return {receiver, start_ == kRoot ? root_weights(receiver) : Quad{}}; }
  // The index of a light for u in [0, 1), and its probability; -1 where no light can reach the receiver.
  int sample(const View& view, float u, float& probability) const;
  // The probability with which sample() finds the light.
  float probability(const View& view, int light) const;
  // An estimate of the irradiance from all lights, without shadows.
  float irradiance(const View& view) const;

 private:
  // Four clusters of lights: bounding spheres, cones of normals, and what they give together. Three cache lines.
  struct alignas(64) Node {
    Quad x, y, z, radius;
    Quad axis_x, axis_y, axis_z;
    Quad depth;  // how far the lights reach along their normals from the centre
    Quad cos_normals, cos_emission;
    Quad intensity;  // in parts of the whole tree's; 0: no child
    int32_t link __attribute__((vector_size(4 * kWidth)));
  };
  struct Leaf {
    glm::vec3 center{0};
    float near2 = 0;       // squared distance from the centre below which the lights face every which way
    int32_t first = 0;     // in order_
    int32_t table = -1;    // in tables_: by intensity; -1 for a single light
    bool octants = false;  // eight tables more follow it
  };
  // Where a light is: which slots lead to it from the root, two bits each, the first lowest; and its place in the leaf.
  struct Place {
    uint64_t trail = 0;
    int32_t in_leaf = 0;
  };
  struct Cluster;
  struct Range;
  class Builder;

  // A link is the index of a node or leaf above two flags.
  static constexpr int32_t kRoot = 0, kDoubleSided = 1, kLeaf = 2;
  static size_t index_of(int32_t link) { return static_cast<size_t>(link >> 2); }

  static int pick_slot(const Quad& weights, float& u, float& probability);
  Quad weigh(const Node& node, const LightReceiver& receiver) const;
  Quad root_weights(const LightReceiver& receiver) const;
  const AliasTable& table_of(const Leaf& leaf, const glm::vec3& position) const;

  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
  std::vector<AliasTable> tables_;
  std::vector<int32_t> order_;  // lights, leaf by leaf
  std::vector<Place> places_;   // by light
  int32_t start_ = kRoot;       // or the link to the only leaf
  float least_distance2_ = 0;   // keeps importances finite at a light's own place
  float total_intensity_ = 0;
};

}  // namespace vitrine::trace
