// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/gltf_meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_inverse.hpp>

#include "host/scene/geometry.h"
#include "host/scene/gltf_accessors.h"
#include "host/scene/thin_solids.h"

namespace vitrine {
namespace {

// Charged as memory, so that meshes of very many tiny parts end in an error and not in hours of work.
constexpr uint64_t kPrimitiveCharge = 65536, kMappingCharge = 256;

enum : int64_t { kPoints = 0, kLines = 1, kLineLoop = 2, kLineStrip = 3, kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6 };

// Vertices of a part of the primitive: a point, a line or a triangle.
uint32_t corners_per_part(int64_t mode) { return mode == kPoints ? 1 : mode < kTriangles ? 2 : 3; }

// How many triangles `n` listed vertices make at most.
size_t most_triangles(int64_t mode, size_t n) {
  if (mode == kPoints) return n * kTrianglesOfPoint;
  if (mode < kTriangles) return (mode == kLines ? n / 2 : n) * kTrianglesOfRod;
  return mode == kTriangles ? n / 3 : n;
}

// The parts' corners in a list of `n` (glTF 2.0, section 3.7.2.1); corners left over make no part.
std::vector<uint32_t> corners_of_mode(int64_t mode, uint32_t n) {
  std::vector<uint32_t> corners;
  if (mode == kPoints || mode == kLines || mode == kTriangles) {
    corners.resize(n / corners_per_part(mode) * corners_per_part(mode));
    for (uint32_t i = 0; i < corners.size(); ++i) corners[i] = i;
    return corners;
  }
  if (mode < kTriangles) {
    for (uint32_t i = 0; i + 1 < n; ++i) corners.insert(corners.end(), {i, i + 1});
    if (mode == kLineLoop && n > 1) corners.insert(corners.end(), {n - 1, 0});
    return corners;
  }
  for (uint32_t i = 0; i + 2 < n; ++i) {
    if (mode == kTriangleStrip)
      corners.insert(corners.end(), {i, i + 1 + i % 2, i + 2 - i % 2});
    else
      corners.insert(corners.end(), {i + 1, i + 2, 0});
  }
  return corners;
}

// Renumbers `corners` so that vertices are numbered as they first appear; returns the old number of each.
std::vector<uint32_t> compact(std::vector<uint32_t>& corners) {
  std::vector<uint32_t> used = corners;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (uint32_t& c : corners) c = static_cast<uint32_t>(std::lower_bound(used.begin(), used.end(), c) - used.begin());
  return used;
}

// Reads one attribute of the used vertices; empty where the primitive has none.
template <typename T, typename Read>
std::vector<T> gather_attribute(GltfDocument& document, const JsonView& attributes, const char* key, int least, int most,
                                size_t vertices, const std::vector<uint32_t>& used, Read read) {
  std::vector<T> values;
  const auto reference = attributes.find(key);
  if (!reference) return values;
  const Accessor accessor = open_accessor(document, *reference, least, most);
  if (accessor.size() != vertices)
    reference->fail(fmt::format("has {} elements, but there are {} positions", accessor.size(), vertices));
  document.charge(used.size() * sizeof(T), *reference);
  values.reserve(used.size());
  for (const uint32_t i : used) values.push_back(read(accessor, i));
  return values;
}

std::vector<glm::vec3> gather_vec3(GltfDocument& document, const JsonView& attributes, const char* key, size_t vertices,
                                   const std::vector<uint32_t>& used) {
  return gather_attribute<glm::vec3>(document, attributes, key, 3, 3, vertices, used,
                                     [](const Accessor& a, size_t i) { return a.vec3(i); });
}

void gather_attributes(GltfDocument& document, const JsonView& attributes, size_t vertices, const std::vector<uint32_t>& used,
                       Geometry& g) {
  const auto vec4 = [](const Accessor& a, size_t i) { return a.vec4(i); };
  const auto vec2 = [](const Accessor& a, size_t i) { return a.vec2(i); };
  g.positions = gather_vec3(document, attributes, "POSITION", vertices, used);
  g.normals = gather_vec3(document, attributes, "NORMAL", vertices, used);
  g.tangents = gather_attribute<glm::vec4>(document, attributes, "TANGENT", 4, 4, vertices, used, vec4);
  g.texcoords[0] = gather_attribute<glm::vec2>(document, attributes, "TEXCOORD_0", 2, 2, vertices, used, vec2);
  g.texcoords[1] = gather_attribute<glm::vec2>(document, attributes, "TEXCOORD_1", 2, 2, vertices, used, vec2);
  g.colors = gather_attribute<glm::vec4>(document, attributes, "COLOR_0", 3, 4, vertices, used, vec4);
  for (glm::vec4& c : g.colors) c = glm::clamp(c, 0.0f, 1.0f);
}

// Morph targets at rest (glTF 2.0, section 3.7.2.2).
void apply_morph(GltfDocument& document, const JsonView& target, float weight, size_t vertices, const std::vector<uint32_t>& used,
                 Geometry& g) {
  if (weight == 0) return;
  const std::vector<glm::vec3> positions = gather_vec3(document, target, "POSITION", vertices, used);
  const std::vector<glm::vec3> normals = gather_vec3(document, target, "NORMAL", vertices, used);
  const std::vector<glm::vec3> tangents = gather_vec3(document, target, "TANGENT", vertices, used);
  for (size_t i = 0; i < positions.size(); ++i) g.positions[i] += weight * positions[i];
  for (size_t i = 0; i < std::min(normals.size(), g.normals.size()); ++i) g.normals[i] += weight * normals[i];
  for (size_t i = 0; i < std::min(tangents.size(), g.tangents.size()); ++i) g.tangents[i] += glm::vec4(weight * tangents[i], 0);
}

void apply_morphs(GltfDocument& document, const JsonView& place, const std::vector<float>& weights, size_t vertices,
                  const std::vector<uint32_t>& used, Geometry& g) {
  const auto targets = place.find("targets");
  if (!targets) return;
  if (!weights.empty() && weights.size() != targets->size())
    targets->fail(fmt::format("there are {} targets, but {} weights", targets->size(), weights.size()));
  for (size_t t = 0; t < weights.size(); ++t) apply_morph(document, (*targets)[t], weights[t], vertices, used, g);
}

// Sum of the joints' matrices of one vertex, weighted (glTF 2.0, section 3.7.3.3).
struct SkinSet {
  Accessor joints, weights;
};

std::vector<SkinSet> open_skin_sets(GltfDocument& document, const JsonView& attributes, size_t vertices) {
  std::vector<SkinSet> sets;
  for (int s = 0; s < 8; ++s) {
    const auto joints = attributes.find(fmt::format("JOINTS_{}", s).c_str());
    const auto weights = attributes.find(fmt::format("WEIGHTS_{}", s).c_str());
    if (!joints || !weights) break;
    sets.push_back({open_joints(document, *joints), open_accessor(document, *weights, 4, 4)});
    if (sets.back().joints.size() != vertices || sets.back().weights.size() != vertices)
      joints->fail(fmt::format("joints and weights must have {} elements, as the positions", vertices));
  }
  return sets;
}

glm::mat4 skin_matrix(const JsonView& place, const std::vector<SkinSet>& sets, const std::vector<glm::mat4>& joints,
                      uint32_t vertex) {
  glm::mat4 matrix(0);
  float sum = 0;
  for (const SkinSet& set : sets) {
    for (int c = 0; c < 4; ++c) {
      const float weight = set.weights.value(vertex, c);
      const uint32_t joint = set.joints.integer(vertex, c);
      if (weight == 0) continue;
      if (joint >= joints.size())
        place.fail(fmt::format("vertex {} hangs on joint {}, but its skin has {}", vertex, joint, joints.size()));
      matrix += joints[joint] * weight;
      sum += weight;
    }
  }
  return sum > 0 ? matrix / sum : glm::mat4(1);
}

void apply_skin(GltfDocument& document, const JsonView& attributes, const std::vector<glm::mat4>& joints, size_t vertices,
                const std::vector<uint32_t>& used, Geometry& g) {
  const std::vector<SkinSet> sets = open_skin_sets(document, attributes, vertices);
  if (sets.empty()) return;
  for (size_t i = 0; i < used.size(); ++i) {
    const glm::mat4 m = skin_matrix(attributes, sets, joints, used[i]);
    g.positions[i] = glm::vec3(m * glm::vec4(g.positions[i], 1));
    const glm::mat3 linear(m);
    if (!g.normals.empty() && std::abs(glm::determinant(linear)) > 1e-20f)
      g.normals[i] = glm::inverseTranspose(linear) * g.normals[i];
    if (!g.tangents.empty()) g.tangents[i] = glm::vec4(linear * glm::vec3(g.tangents[i]), g.tangents[i].w);
  }
}

void check_finite(const JsonView& place, const Geometry& g) {
  constexpr float kFarthest = 1e12f;  // metres; squares of it are far from overflow
  for (const glm::vec3& p : g.positions)
    for (int c = 0; c < 3; ++c)
      if (!(std::abs(p[c]) < kFarthest)) place.fail("a vertex lies farther than 1e12 metres away");
}

// Tangents of unit length, in the surface, with handedness 1 or -1.
void repair_tangents(Geometry& g) {
  for (size_t i = 0; i < g.tangents.size(); ++i) {
    const glm::vec3 t = glm::vec3(g.tangents[i]) - g.normals[i] * glm::dot(g.normals[i], glm::vec3(g.tangents[i]));
    const float length = glm::length(t), w = g.tangents[i].w < 0 ? -1.0f : 1.0f;
    const glm::vec3 other = std::abs(g.normals[i].x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    g.tangents[i] = glm::vec4(length > 1e-12f ? t / length : glm::normalize(glm::cross(g.normals[i], other)), w);
  }
}

void for_textures(const Material& m, auto&& visit) {
  for (const TextureRef* ref : {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture, &m.emissive_texture,
                                &m.specular_texture, &m.specular_color_texture, &m.transmission_texture, &m.thickness_texture,
                                &m.clearcoat_texture, &m.clearcoat_roughness_texture, &m.clearcoat_normal_texture})
    if (*ref) visit(*ref);
}

// The texture whose coordinates the tangents follow, or null.
const TextureRef* normal_map_of(const Material& m) {
  if (m.normal_texture) return &m.normal_texture;
  return m.clearcoat_normal_texture ? &m.clearcoat_normal_texture : nullptr;
}

}  // namespace

void GltfMeshes::charge(size_t vertices, size_t triangles, const JsonView& place) {
  vertices_ += vertices;
  triangles_ += triangles;
  if (vertices_ > kMostSceneVertices || triangles_ > kMostSceneTriangles)
    place.fail("the scene has more than 20 million vertices or triangles", "reduce the model");
}

std::vector<uint32_t> GltfMeshes::read_corners(const JsonView& place, size_t vertices, int64_t mode) {
  const auto reference = place.find("indices");
  if (!reference) {
    charge(0, most_triangles(mode, vertices), place);
    return corners_of_mode(mode, static_cast<uint32_t>(vertices));
  }
  const Accessor indices = open_indices(document_, *reference);
  charge(0, most_triangles(mode, indices.size()), place);
  std::vector<uint32_t> corners = corners_of_mode(mode, static_cast<uint32_t>(indices.size()));
  if (mode == kTriangles && corners.size() != indices.size())
    document_.warn(
        fmt::format("{} has {} corners, which is no multiple of 3; the last are left out", place.where(), indices.size()));
  for (uint32_t& corner : corners) {
    corner = indices.integer(corner, 0);
    if (corner >= vertices) reference->fail(fmt::format("vertex {} is used, but there are {}", corner, vertices));
  }
  return corners;
}

// The primitive's own material, then one per wanted variant.
std::vector<int> GltfMeshes::materials_of(const JsonView& place) {
  const int own = place.index_or_none("material", "materials", document_.count("materials"));
  std::vector<int> materials(1 + variants_.size(), materials_.use(own));
  if (variants_.empty()) return materials;
  const auto extension = place.extension("KHR_materials_variants");
  if (!extension) return materials;
  const JsonView mappings = extension->at("mappings");
  for (size_t m = 0; m < mappings.size(); ++m) {
    const int material = mappings[m].index_or_none("material", "materials", document_.count("materials"));
    const JsonView values = mappings[m].at("variants");
    document_.charge(kMappingCharge * (1 + values.size() * variants_.size()), place);
    for (size_t v = 0; v < values.size(); ++v) {
      const int64_t variant = values[v].integer(0, INT32_MAX);
      for (size_t wanted = 0; wanted < variants_.size(); ++wanted)
        if (variants_[wanted] == variant) materials[1 + wanted] = materials_.use(material);
    }
  }
  return materials;
}

void GltfMeshes::read_primitive(const JsonView& place, const std::vector<float>& weights, const MeshInstance& instance,
                                Object& object) {
  const int64_t mode = place.integer_or("mode", kTriangles, kPoints, kTriangleFan);
  const JsonView attributes = place.at("attributes");
  const auto position = attributes.find("POSITION");
  document_.charge(kPrimitiveCharge, place);
  if (!position) return document_.warn(place.where() + " has no positions and is not shown");
  const size_t vertices = open_accessor(document_, *position, 3, 3).size();
  Geometry g;
  g.indices = read_corners(place, vertices, mode);
  if (g.indices.empty()) return;
  const std::vector<uint32_t> used = compact(g.indices);
  charge(used.size(), 0, place);
  gather_attributes(document_, attributes, vertices, used, g);
  apply_morphs(document_, place, weights, vertices, used, g);
  if (!instance.joints.empty()) apply_skin(document_, attributes, instance.joints, vertices, used, g);
  check_finite(place, g);
  if (mode == kPoints) make_octahedra(g);
  if (mode > kPoints && mode < kTriangles) make_rods(g);
  drop_degenerate_triangles(g);
  if (g.indices.empty()) return;
  if (g.normals.empty()) {
    make_flat_normals(g);
    charge(g.positions.size(), 0, place);
  } else {
    repair_normals(g);
  }

  const std::vector<int> materials = materials_of(place);
  const TextureRef* normal_map = nullptr;
  for (const int m : materials) {
    const Material& material = (*scene_materials_)[static_cast<size_t>(m)];
    if (!normal_map) normal_map = normal_map_of(material);
    for_textures(material, [&](const TextureRef& ref) {
      std::vector<glm::vec2>& uv = g.texcoords[static_cast<size_t>(ref.texcoord)];
      if (!uv.empty()) return;
      document_.warn(fmt::format("{} has a texture but no TEXCOORD_{}; (0, 0) is taken", place.where(), ref.texcoord));
      uv.assign(g.positions.size(), glm::vec2(0));
    });
  }
  if (!g.tangents.empty())
    repair_tangents(g);
  else if (normal_map)
    make_tangents(g, normal_map->texcoord, normal_map->transform);
  g.triangle_materials.assign(g.indices.size() / 3, materials[0]);
  for (size_t v = 0; v < variants_.size(); ++v)
    object.variant_materials[v].insert(object.variant_materials[v].end(), g.triangle_materials.size(), materials[1 + v]);
  append_geometry(object.geometry, g);
}

bool GltfMeshes::read(const MeshInstance& instance, Object& object) {
  const JsonView mesh = document_.element("meshes", instance.mesh);
  std::vector<float> weights = instance.weights;
  if (const auto own = mesh.find("weights"); own && weights.empty()) {
    weights.resize(own->size());
    own->numbers(weights, -1e6, 1e6);
  }
  object.variant_materials.assign(variants_.size(), {});
  const JsonView primitives = mesh.at("primitives");
  for (size_t p = 0; p < primitives.size(); ++p) read_primitive(primitives[p], weights, instance, object);
  const bool same = std::all_of(object.variant_materials.begin(), object.variant_materials.end(),
                                [&](const std::vector<int>& m) { return m == object.geometry.triangle_materials; });
  if (same) object.variant_materials.clear();
  if (object.geometry.indices.empty()) document_.warn(mesh.where() + " has nothing to show");
  return !object.geometry.indices.empty();
}

}  // namespace vitrine
