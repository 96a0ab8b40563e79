// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/trace/light_tree.h"

#include <array>
#include <limits>
#include <numeric>

namespace vitrine::trace {
namespace {

constexpr int kBins = 12;  // candidates for a split along each axis
// A leaf of several lights: at most so many, whose surfaces fill this share of their bounding sphere's disk. (Less, and they are
// several lamps, far apart; more lights, and a surface is so large that distances matter.)
constexpr int kLeafLights = 4096;
constexpr float kFilled = 0.25f;
constexpr float kFlat = 0.85f;             // cosine of half the cone of normals up to which octants make no difference
constexpr float kNear = 1.5f;              // radii from a leaf's centre within which its lights are chosen by intensity
constexpr float kLeastCosine = 0.05f;      // of a light to an octant that it faces away from: positive, since octants are coarse
constexpr int kBalancedDepth = 16;         // below it, splits halve the count: no light is deeper than 32
constexpr float kLeastIntensity = 1e-30f;  // in parts of the whole: positive after all products
constexpr float kLeastDistance = 1e-6f;    // in parts of the tree's radius

using Quad = float __attribute__((vector_size(16)));

inline Quad square_root(Quad v) { return Quad{std::sqrt(v[0]), std::sqrt(v[1]), std::sqrt(v[2]), std::sqrt(v[3])}; }
inline Quad least(Quad a, Quad b) { return a < b ? a : b; }
inline Quad greatest(Quad a, Quad b) { return a > b ? a : b; }

// cos(min(a + b, pi)) for angles in [0, pi].
float cos_of_sum(float cos_a, float cos_b) {
  if (cos_a <= -cos_b) return -1;
  return cos_a * cos_b - safe_sqrt(1 - cos_a * cos_a) * safe_sqrt(1 - cos_b * cos_b);
}

// Measure of the directions that a cone of normals lights: Conty Estevez and Kulla 2018, section 4.4, for surfaces, which emit
// up to 90 degrees from their normals. For cones wider than a half space, (pi - angle) is replaced by (1 + cos) pi / 2.
float orientation_measure(float cos_normals) {
  const float sin_normals = safe_sqrt(1 - cos_normals * cos_normals);
  const float around = kPi * kPi / 2 * sin_normals;
  return 2 * kPi * (1 - cos_normals) + (cos_normals > 0 ? around + kPi * cos_normals : around * (1 + cos_normals));
}

// What makes the cost of a set of lights, such that sets can be joined.
struct Extent {
  glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
  glm::vec3 axes{0};  // sum of axes by intensity
  float intensity = 0, cos_emission = 1;
  int count = 0;

  void add(const LightBounds& light, const glm::vec3& reference) {
    const float turn = light.double_sided && glm::dot(light.axis, reference) < 0 ? -1.0f : 1.0f;
    low = glm::min(low, light.low);
    high = glm::max(high, light.high);
    axes += light.axis * (turn * light.intensity * 0.5f * (1 + light.cos_normals));
    intensity += light.intensity;
    cos_emission = std::min(cos_emission, light.cos_emission);
    ++count;
  }
  void add(const Extent& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
    axes += other.axes;
    intensity += other.intensity;
    cos_emission = std::min(cos_emission, other.cos_emission);
    count += other.count;
  }
  // The surface area orientation heuristic (Conty Estevez and Kulla 2018, section 4.4), with the squared diagonal, which is not
  // 0 for lights in a row, as the area. The cone is that of the cap whose directions have the same mean: of length (1 + cos) / 2.
  float cost() const {
    if (count == 0) return 0;
    const float cos_normals = std::clamp(2 * glm::length(axes) / std::max(intensity, 1e-37f) - 1, -1.0f, 1.0f);
    const glm::vec3 diagonal = high - low;
    return intensity * glm::dot(diagonal, diagonal) * orientation_measure(cos_normals);
  }
};

int octant_of(const glm::vec3& v) { return (v.x < 0 ? 1 : 0) | (v.y < 0 ? 2 : 0) | (v.z < 0 ? 4 : 0); }

// Root mean square, over directions of the octant, of what a light sends there: the choice in proportion to it has the least
// variance over all of them.
float cosine_to_octant(const LightBounds& light, int octant) {
  constexpr int kSteps = 3;
  const glm::vec3 sign(octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1);
  float squares = 0;
  for (int i = 0; i < kSteps * kSteps; ++i) {  // evenly by solid angle: steps of the cosine and of the angle about it
    const float z = (static_cast<float>(i % kSteps) + 0.5f) / kSteps, s = safe_sqrt(1 - z * z);
    const float phi = kPi / 2 * (static_cast<float>(i / kSteps) + 0.5f) / kSteps;
    const float cosine = glm::dot(light.axis, sign * glm::vec3(s * std::cos(phi), s * std::sin(phi), z));
    squares += sqr(std::max(light.double_sided ? std::fabs(cosine) : cosine, 0.0f));
  }
  return std::max(std::sqrt(squares / (kSteps * kSteps)), kLeastCosine);
}

glm::vec3 center_of(const LightBounds& light) { return 0.5f * (light.low + light.high); }

// Bins along each axis over the centres of lights.
struct Grid {
  glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};

  void add(const glm::vec3& center) {
    low = glm::min(low, center);
    high = glm::max(high, center);
  }
  float extent(int axis) const { return high[axis] - low[axis]; }
  int longest_axis() const {
    const int axis = extent(1) > extent(0) ? 1 : 0;
    return extent(2) > extent(axis) ? 2 : axis;
  }
  int bin(const glm::vec3& center, int axis) const {
    return std::min(static_cast<int>((center[axis] - low[axis]) / extent(axis) * kBins), kBins - 1);
  }
};

}  // namespace

// What a slot of a node says of its lights.
struct LightTree::Cluster {
  glm::vec3 center{0}, axis{0, 0, 1};
  float radius = 0, depth = 0, cos_normals = 1, cos_emission = 1, area = 0;
  double intensity = 0;
  bool double_sided = false;
};

struct LightTree::Range {
  int first = 0, last = 0;
  Cluster cluster;
  bool leaf = false;
  float cost = 0;
};

class LightTree::Builder {
 public:
  Builder(LightTree& tree, std::span<const LightBounds> lights) : tree_(tree), lights_(lights) {}
  void build();

 private:
  struct Cut {
    int axis = -1, bin = 0;  // the last bin of the first half
    float cost = std::numeric_limits<float>::infinity();
  };
  const LightBounds& light(int i) const { return lights_[static_cast<size_t>(tree_.order_[static_cast<size_t>(i)])]; }
  Range range(int first, int last) const;
  Cluster cluster_of(int first, int last) const;
  float cos_of_normals(int first, int last, const glm::vec3& axis) const;
  float depth_of(int first, int last, const Cluster& cluster) const;
  int split(const Range& range, bool balanced);
  Cut cheapest_cut(const Range& range, const Grid& grid, int axis) const;
  int split_in_half(const Range& range, int axis);
  int32_t add_node(const Range& range, int depth, uint64_t trail);
  int32_t add_leaf(const Range& range, uint64_t trail);

  LightTree& tree_;
  std::span<const LightBounds> lights_;
  double total_ = 0;
};

void LightTree::Builder::build() {
  tree_.order_.resize(lights_.size());
  std::iota(tree_.order_.begin(), tree_.order_.end(), 0);
  tree_.places_.resize(lights_.size());
  for (const LightBounds& l : lights_) total_ += l.intensity;
  tree_.total_intensity_ = static_cast<float>(std::min(total_, 1e30));
  const Range all = range(0, static_cast<int>(lights_.size()));
  tree_.least_distance2_ = std::max(sqr(kLeastDistance * all.cluster.radius), 1e-30f);
  tree_.start_ = add_node(all, 0, 0);
  if (all.leaf) tree_.start_ = tree_.nodes_[0].link[0];
}

LightTree::Range LightTree::Builder::range(int first, int last) const {
  Range r{first, last, cluster_of(first, last)};
  const Cluster& c = r.cluster;
  const int count = last - first;
  r.cost = static_cast<float>(c.intensity / total_) * sqr(c.radius) * orientation_measure(c.cos_normals);
  r.leaf = count == 1 || (count <= kLeafLights && c.area > 0 && c.area >= kFilled * kPi * sqr(c.radius));
  return r;
}

LightTree::Cluster LightTree::Builder::cluster_of(int first, int last) const {
  Extent extent;
  Cluster c;
  for (int i = first; i < last; ++i) {
    extent.add(light(i), light(first).axis);
    c.area += light(i).area;
    c.intensity += light(i).intensity;
    c.double_sided = c.double_sided || light(i).double_sided;
  }
  c.center = 0.5f * (extent.low + extent.high);
  c.cos_emission = extent.cos_emission;
  for (int i = first; i < last; ++i) {
    const glm::vec3 farthest = glm::max(glm::abs(light(i).low - c.center), glm::abs(light(i).high - c.center));
    c.radius = std::max(c.radius, glm::length(farthest));
  }
  const float length = glm::length(extent.axes);
  if (last - first == 1) {
    c.axis = light(first).axis;
    c.cos_normals = light(first).cos_normals;
  } else if (length > 0 && std::isfinite(length)) {
    c.axis = extent.axes / length;
    c.cos_normals = cos_of_normals(first, last, c.axis);
  } else {
    c.cos_normals = -1;
  }
  c.depth = depth_of(first, last, c);
  return c;
}

float LightTree::Builder::cos_of_normals(int first, int last, const glm::vec3& axis) const {
  float cosine = 1;
  for (int i = first; i < last; ++i) {
    const float apart = std::clamp(glm::dot(light(i).axis, axis), -1.0f, 1.0f);
    cosine = std::min(cosine, cos_of_sum(light(i).double_sided ? std::fabs(apart) : apart, light(i).cos_normals));
  }
  return cosine;
}

// A normal that is off the axis by an angle differs from it by the chord, 2 sin(angle / 2).
float LightTree::Builder::depth_of(int first, int last, const Cluster& c) const {
  const float chord = safe_sqrt(2 * (1 - c.cos_normals));
  float depth = -c.radius;
  for (int i = first; i < last; ++i) {
    const float along = glm::dot(c.axis, center_of(light(i)) - c.center);
    const float thickness = glm::dot(glm::abs(c.axis), 0.5f * (light(i).high - light(i).low));
    depth = std::max(depth, (c.double_sided ? std::fabs(along) : along) + thickness);
  }
  return std::min(depth + chord * c.radius, c.radius);
}

// The position in the order where the second half begins.
int LightTree::Builder::split(const Range& r, bool balanced) {
  Grid grid;
  for (int i = r.first; i < r.last; ++i) grid.add(center_of(light(i)));
  const int longest = grid.longest_axis();
  const float extent = grid.extent(longest);
  if (balanced || !(extent > 0) || !std::isfinite(extent)) return split_in_half(r, longest);

  Cut best;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(grid.extent(axis) > 0)) continue;
    Cut cut = cheapest_cut(r, grid, axis);
    cut.cost *= extent / grid.extent(axis);  // thin slices are bad clusters
    if (cut.cost < best.cost) best = cut;
  }
  if (best.axis < 0) return split_in_half(r, longest);
  const auto begin = tree_.order_.begin();
  const auto middle = std::stable_partition(begin + r.first, begin + r.last, [&](int32_t i) {
    return grid.bin(center_of(lights_[static_cast<size_t>(i)]), best.axis) <= best.bin;
  });
  return static_cast<int>(middle - begin);
}

LightTree::Builder::Cut LightTree::Builder::cheapest_cut(const Range& r, const Grid& grid, int axis) const {
  std::array<Extent, kBins> bins, left;  // left[b]: all bins to b
  for (int i = r.first; i < r.last; ++i) {
    bins[static_cast<size_t>(grid.bin(center_of(light(i)), axis))].add(light(i), light(r.first).axis);
  }
  left[0] = bins[0];
  for (size_t b = 1; b < kBins; ++b) (left[b] = left[b - 1]).add(bins[b]);
  Cut best;
  Extent right;
  for (int b = kBins - 2; b >= 0; --b) {
    right.add(bins[static_cast<size_t>(b) + 1]);
    const Extent& other = left[static_cast<size_t>(b)];
    const float cost = other.cost() + right.cost();
    if (other.count > 0 && right.count > 0 && cost < best.cost) best = {axis, b, cost};
  }
  return best;
}

int LightTree::Builder::split_in_half(const Range& r, int axis) {
  const int middle = r.first + (r.last - r.first) / 2;
  const auto begin = tree_.order_.begin();
  std::nth_element(begin + r.first, begin + middle, begin + r.last, [&](int32_t a, int32_t b) {
    const float at_a = center_of(lights_[static_cast<size_t>(a)])[axis], at_b = center_of(lights_[static_cast<size_t>(b)])[axis];
    return at_a != at_b ? at_a < at_b : a < b;
  });
  return middle;
}

int32_t LightTree::Builder::add_node(const Range& all, int depth, uint64_t trail) {
  // Open the cluster that costs most until there are four.
  const bool balanced = depth >= kBalancedDepth;
  const auto rank = [&](const Range& r) { return r.leaf ? -1.0f : balanced ? static_cast<float>(r.last - r.first) : r.cost; };
  const auto below = [&](const Range& a, const Range& b) { return rank(a) < rank(b); };
  std::vector<Range> parts = {all};
  while (parts.size() < kWidth) {
    const auto opened = std::max_element(parts.begin(), parts.end(), below);
    if (opened->leaf) break;
    const Range whole = *opened;
    const int middle = split(whole, balanced);
    *opened = range(whole.first, middle);
    parts.insert(opened + 1, range(middle, whole.last));
  }

  const size_t index = tree_.nodes_.size();
  tree_.nodes_.emplace_back();  // its children come after it
  Node node{};
  for (size_t i = 0; i < parts.size(); ++i) {
    const Cluster& c = parts[i].cluster;
    node.x[i] = c.center.x;
    node.y[i] = c.center.y;
    node.z[i] = c.center.z;
    node.radius[i] = c.radius;
    node.axis_x[i] = c.axis.x;
    node.axis_y[i] = c.axis.y;
    node.axis_z[i] = c.axis.z;
    node.cos_normals[i] = c.cos_normals;
    node.depth[i] = c.depth;
    node.cos_emission[i] = c.cos_emission;
    node.intensity[i] = std::max(static_cast<float>(c.intensity / total_), kLeastIntensity);
    const uint64_t to_part = trail | static_cast<uint64_t>(i) << (2 * depth);
    node.link[i] = (parts[i].leaf ? add_leaf(parts[i], to_part) : add_node(parts[i], depth + 1, to_part)) |
                   (c.double_sided ? kDoubleSided : 0);
  }
  tree_.nodes_[index] = node;
  return static_cast<int32_t>(index << 2);
}

int32_t LightTree::Builder::add_leaf(const Range& r, uint64_t trail) {
  Leaf leaf{r.cluster.center, sqr(kNear * r.cluster.radius), r.first};
  const size_t count = static_cast<size_t>(r.last - r.first);
  std::vector<float> intensities(count), weights(count);
  for (size_t i = 0; i < count; ++i) {
    const auto index = static_cast<size_t>(tree_.order_[static_cast<size_t>(r.first) + i]);
    tree_.places_[index] = {trail, static_cast<int32_t>(i)};
    intensities[i] = std::max(static_cast<float>(lights_[index].intensity / total_), kLeastIntensity);
  }
  if (count > 1) {
    leaf.table = static_cast<int32_t>(tree_.tables_.size());
    leaf.octants = r.cluster.cos_normals < kFlat;
    tree_.tables_.emplace_back(intensities);
  }
  for (int octant = 0; leaf.octants && octant < 8; ++octant) {
    for (size_t i = 0; i < count; ++i) {
      weights[i] = intensities[i] * cosine_to_octant(light(r.first + static_cast<int>(i)), octant);
    }
    tree_.tables_.emplace_back(weights);
  }
  tree_.leaves_.push_back(leaf);
  return static_cast<int32_t>((tree_.leaves_.size() - 1) << 2) | kLeaf;
}

LightTree::LightTree(std::span<const LightBounds> lights) {
  if (!lights.empty()) Builder(*this, lights).build();
}

// A slot in proportion to the weights, its probability, and a fresh uniform number in place of u. -1 where all weigh nothing.
inline int LightTree::pick_slot(const Quad& w, float& u, float& probability) {
  const float s0 = w[0], s1 = s0 + w[1], s2 = s1 + w[2], sum = s2 + w[3];
  if (!(sum > 0)) return -1;
  const float x = u * sum;
  const int slot = static_cast<int>(x >= s0) + static_cast<int>(x >= s1) + static_cast<int>(x >= s2);
  const float before[] = {0, s0, s1, s2};
  u = std::min((x - before[slot]) / w[slot], kBeforeOne);
  probability = w[slot] / sum;
  return slot;
}

// What the clusters may give the receiver, in parts of the whole tree's intensity: the importance of pbrt-v4, 12.6.3, for four
// clusters at once. Instead of the angle under which a bounding sphere is seen, lengths are added to heights: a light at q with
// a normal m gives p light if m . (p - q) > 0, and that is at most m . (p - c) + depth, or + radius, around the centre c. So no
// light is missed, and square roots that do not wait for each other are enough.
inline LightTree::Quad LightTree::weigh(const Node& n, const LightReceiver& receiver) const {
  const Quad x = receiver.position.x - n.x, y = receiver.position.y - n.y, z = receiver.position.z - n.z;
  const Quad distance2 = greatest(x * x + y * y + z * z, Quad{} + least_distance2_);
  const Quad distance = square_root(distance2);
  const Quad weight = n.intensity / greatest(distance2, n.radius * n.radius);

  // Height of the receiver over the cluster's centre along the normal, within the cone, that is next to it.
  const Quad signed_along = n.axis_x * x + n.axis_y * y + n.axis_z * z;
  const Quad along = (n.link & kDoubleSided) != 0 ? greatest(signed_along, -signed_along) : signed_along;
  const Quad across = square_root(greatest(distance2 - along * along, Quad{}));
  const Quad sin_normals = square_root(greatest(1 - n.cos_normals * n.cos_normals, Quad{}));
  const Quad turned = along * n.cos_normals + across * sin_normals;
  const Quad height = along < n.cos_normals * distance ? turned : distance;
  const Quad inverse = 1 / distance;
  const Quad emitted = weight * least((height + n.radius) * inverse, Quad{} + 1);
  const Quad lit = height + n.depth > n.cos_emission * (distance - n.radius) ? emitted : Quad{};
  if (is_black(receiver.normal)) return lit;

  // Height of the cluster over the receiver's horizon.
  const glm::vec3 normal = -receiver.normal;
  const Quad over = normal.x * x + normal.y * y + normal.z * z + n.radius;
  const Quad received = least(greatest(over * inverse, Quad{} + kLeastReceivedCosine), Quad{} + 1);
  return over > 0 ? lit * received : Quad{};
}

LightTree::Quad LightTree::root_weights(const LightReceiver& receiver) const {
  return empty() ? Quad{} : weigh(nodes_[0], receiver);
}

int LightTree::sample(const View& view, float u, float& probability) const {
  if (empty()) return -1;
  probability = 1;
  int32_t link = start_;
  while (!(link & kLeaf)) {
    const Node& node = nodes_[index_of(link)];
    float chance;
    const int slot = pick_slot(link == kRoot ? view.root : weigh(node, view.receiver), u, chance);
    if (slot < 0) return -1;
    probability *= chance;
    link = node.link[slot];
  }
  const Leaf& leaf = leaves_[index_of(link)];
  if (leaf.table < 0) return order_[static_cast<size_t>(leaf.first)];
  const AliasTable& table = table_of(leaf, view.receiver.position);
  const int i = table.sample(u);
  probability *= table.probability(i);
  return order_[static_cast<size_t>(leaf.first + i)];
}

inline const AliasTable& LightTree::table_of(const Leaf& leaf, const glm::vec3& position) const {
  const glm::vec3 offset = position - leaf.center;
  const bool far = leaf.octants && glm::dot(offset, offset) > leaf.near2;
  return tables_[static_cast<size_t>(leaf.table + (far ? 1 + octant_of(offset) : 0))];
}

float LightTree::probability(const View& view, int light) const {
  const Place& place = places_[static_cast<size_t>(light)];
  int32_t link = start_;
  float probability = 1;
  for (uint64_t trail = place.trail; !(link & kLeaf); trail >>= 2) {
    const Node& node = nodes_[index_of(link)];
    const auto slot = trail & 3;
    const Quad weights = link == kRoot ? view.root : weigh(node, view.receiver);
    if (!(weights[slot] > 0)) return 0;
    probability *= weights[slot] / (weights[0] + weights[1] + weights[2] + weights[3]);
    link = node.link[slot];
  }
  const Leaf& leaf = leaves_[index_of(link)];
  if (leaf.table < 0) return probability;
  return probability * table_of(leaf, view.receiver.position).probability(place.in_leaf);
}

float LightTree::irradiance(const View& view) const {
  const Quad root = start_ == kRoot ? view.root : root_weights(view.receiver);
  return std::min(total_intensity_ * (root[0] + root[1] + root[2] + root[3]), 1e30f);
}

}  // namespace vitrine::trace
