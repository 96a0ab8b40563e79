// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/gltf_nodes.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "formats/image.h"
#include "host/scene/gltf_accessors.h"
#include "host/scene/text.h"

namespace vitrine {
namespace {

constexpr double kFarthest = 1e12;
constexpr size_t kMostGltfNodes = 1 << 18;

glm::mat4 matrix_from(const std::array<float, 16>& m) {
  glm::mat4 matrix;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) matrix[c][r] = m[static_cast<size_t>(4 * c + r)];
  return matrix;
}

void read_matrix(const JsonView& place, RigNode& node) {
  std::array<float, 16> m{};
  place.numbers(m, -kFarthest, kFarthest);
  node.matrix = matrix_from(m);
  const bool affine = std::abs(m[3]) + std::abs(m[7]) + std::abs(m[11]) + std::abs(m[15] - 1) < 1e-4f;
  if (!affine) place.fail("is not an affine transform: its last row must be 0 0 0 1");
  for (int c = 0; c < 4; ++c) node.matrix[c][3] = c == 3 ? 1.0f : 0.0f;
}

RigNode read_transform(const JsonView& place) {
  RigNode node;
  std::array<float, 3> t{0, 0, 0}, s{1, 1, 1};
  std::array<float, 4> r{0, 0, 0, 1};
  if (const auto matrix = place.find("matrix")) read_matrix(*matrix, node);
  if (const auto v = place.find("translation")) v->numbers(t, -kFarthest, kFarthest);
  if (const auto v = place.find("scale")) v->numbers(s, -kFarthest, kFarthest);
  const auto rotation = place.find("rotation");
  if (rotation) rotation->numbers(r, -2, 2);
  if (place.find("matrix") && (rotation || place.find("translation") || place.find("scale")))
    place.fail("has both a matrix and translation, rotation or scale");
  const glm::quat q(r[3], r[0], r[1], r[2]);
  if (glm::length(q) < 1e-3f) rotation->fail("is not a rotation: the quaternion has no length");
  node.translation = {t[0], t[1], t[2]};
  node.rotation = glm::normalize(q);
  node.scale = {s[0], s[1], s[2]};
  return node;
}

glm::mat4 local_matrix(const RigNode& node) {
  return glm::scale(glm::translate(glm::mat4(1), node.translation) * glm::mat4_cast(node.rotation), node.scale) * node.matrix;
}

// One matrix per joint; identities where the skin has none.
std::vector<glm::mat4> read_inverse_bind_matrices(GltfDocument& document, const JsonView& skin, size_t joints) {
  std::vector<glm::mat4> matrices(joints, glm::mat4(1));
  const auto reference = skin.find("inverseBindMatrices");
  if (!reference) return matrices;
  const std::vector<float> values = read_floats(document, *reference, 16);
  if (values.size() < 16 * joints) reference->fail(fmt::format("has fewer matrices than the skin has joints ({})", joints));
  for (size_t j = 0; j < joints; ++j) {
    std::array<float, 16> m{};
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(16 * j), 16, m.begin());
    matrices[j] = matrix_from(m);
  }
  return matrices;
}

class NodeReader {
 public:
  explicit NodeReader(GltfDocument& document) : document_(document) {}

  GltfNodes read() {
    const size_t count = document_.count("nodes");
    if (count > kMostGltfNodes) document_.root().at("nodes").fail("there are more than 262144 nodes", "reduce the model");
    nodes_.parent.assign(count, -1);
    children_.resize(count);
    for (size_t n = 0; n < count; ++n) read_children(static_cast<int>(n));
    for (size_t n = 0; n < count; ++n) local_.push_back(read_transform(node(static_cast<int>(n))));
    place_all();
    nodes_.rig_of.assign(count, -1);
    for (const int root : scene_roots()) collect(root);
    return std::move(nodes_);
  }

 private:
  JsonView node(int index) const { return document_.element("nodes", index); }

  void read_children(int n) {
    const auto list = node(n).find("children");
    if (!list) return;
    for (size_t i = 0; i < list->size(); ++i) {
      const int64_t child = (*list)[i].integer(0, INT32_MAX);
      if (static_cast<size_t>(child) >= nodes_.size())
        (*list)[i].fail(fmt::format("is {}, but there are {} nodes", child, nodes_.size()));
      int& parent = nodes_.parent[static_cast<size_t>(child)];
      if (parent >= 0) (*list)[i].fail(fmt::format("node {} is already a child of node {}", child, parent));
      parent = n;
      children_[static_cast<size_t>(n)].push_back(static_cast<int>(child));
    }
  }

  // Every node has one parent at most, so what the roots do not reach lies on a cycle.
  void place_all() {
    nodes_.world_at_rest.assign(nodes_.size(), glm::mat4(1));
    std::vector<int> open;
    size_t reached = 0;
    for (size_t n = nodes_.size(); n-- > 0;)
      if (nodes_.parent[n] < 0) open.push_back(static_cast<int>(n));
    while (!open.empty()) {
      const size_t n = static_cast<size_t>(open.back());
      open.pop_back();
      ++reached;
      const int parent = nodes_.parent[n];
      nodes_.world_at_rest[n] =
          (parent < 0 ? glm::mat4(1) : nodes_.world_at_rest[static_cast<size_t>(parent)]) * local_matrix(local_[n]);
      open.insert(open.end(), children_[n].begin(), children_[n].end());
    }
    if (reached != nodes_.size()) document_.root().at("nodes").fail("some nodes are children of their own children");
  }

  std::vector<int> scene_roots() {
    std::vector<int> roots;
    const int wanted = document_.root().index_or_none("scene", "scenes", document_.count("scenes"));
    if (document_.count("scenes") == 0) {
      for (size_t n = 0; n < nodes_.size(); ++n)
        if (nodes_.parent[n] < 0) roots.push_back(static_cast<int>(n));
      return roots;
    }
    const auto list = document_.element("scenes", std::max(0, wanted)).find("nodes");
    if (!list) return roots;
    for (size_t i = 0; i < list->size(); ++i) {
      const int64_t root = (*list)[i].integer(0, INT32_MAX);
      if (static_cast<size_t>(root) >= nodes_.size())
        (*list)[i].fail(fmt::format("is {}, but there are {} nodes", root, nodes_.size()));
      if (nodes_.parent[static_cast<size_t>(root)] >= 0) (*list)[i].fail(fmt::format("node {} is the child of another", root));
      roots.push_back(static_cast<int>(root));
    }
    return roots;
  }

  // Depth first, children in the file's order.
  void collect(int root) {
    if (nodes_.rig_of[static_cast<size_t>(root)] >= 0) return;  // a root named twice
    std::vector<int> open{root};
    while (!open.empty()) {
      const size_t n = static_cast<size_t>(open.back());
      open.pop_back();
      nodes_.rig_of[n] = static_cast<int>(nodes_.order.size());
      nodes_.order.push_back(static_cast<int>(n));
      RigNode rig = local_[n];
      rig.parent = nodes_.parent[n] < 0 ? -1 : nodes_.rig_of[static_cast<size_t>(nodes_.parent[n])];
      nodes_.rig.push_back(rig);
      nodes_.names.push_back(node(static_cast<int>(n)).text_or("name", ""));
      if (nodes_.order.size() > kMaxRigNodes / 2)
        document_.root().at("nodes").fail("the scene has more than 32768 nodes", "reduce the model");
      open.insert(open.end(), children_[n].rbegin(), children_[n].rend());
    }
  }

  GltfDocument& document_;
  GltfNodes nodes_;
  std::vector<std::vector<int>> children_;
  std::vector<RigNode> local_;
};

}  // namespace

GltfNodes read_nodes(GltfDocument& document) { return NodeReader(document).read(); }

GltfSkin read_skin(GltfDocument& document, const GltfNodes& nodes, int skin) {
  const JsonView place = document.element("skins", skin);
  const JsonView joints = place.at("joints");
  document.charge(joints.size() * 256, place);
  GltfSkin result;
  for (size_t j = 0; j < joints.size(); ++j) {
    const int64_t joint = joints[j].integer(0, INT32_MAX);
    if (static_cast<size_t>(joint) >= nodes.size())
      joints[j].fail(fmt::format("is {}, but there are {} nodes", joint, nodes.size()));
    result.joints.push_back({nodes.rig_of[static_cast<size_t>(joint)], glm::mat4(1)});
    result.world_from_bind.push_back(nodes.world_at_rest[static_cast<size_t>(joint)]);
  }
  const std::vector<glm::mat4> inverse = read_inverse_bind_matrices(document, place, result.joints.size());
  for (size_t j = 0; j < result.joints.size(); ++j) {
    result.world_from_bind[j] *= inverse[j];
    result.joints[j].node_from_bind = result.joints[j].node < 0 ? result.world_from_bind[j] : inverse[j];
  }
  return result;
}

}  // namespace vitrine
