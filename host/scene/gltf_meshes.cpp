// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/scene/gltf_meshes.h"

#include <fmt/format.h>

#include <algorithm>

#include "host/scene/gltf_accessors.h"
#include "host/scene/text.h"
#include "host/scene/thin_solids.h"

namespace vitrine {
namespace {

// Charged as memory, so that meshes of very many tiny parts end in an error and not in hours of work.
constexpr uint64_t kPrimitiveCharge = 65536, kMappingCharge = 256;

enum : int64_t { kPoints = 0, kLines = 1, kLineLoop = 2, kLineStrip = 3, kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6 };

// Vertices of a part of the primitive: a point, a line or a triangle.
uint32_t corners_per_part(int64_t mode) { return mode == kPoints ? 1 : mode < kTriangles ? 2 : 3; }

PrimitiveParts parts_of_mode(int64_t mode) {
  return mode == kPoints ? PrimitiveParts::kPoints : mode < kTriangles ? PrimitiveParts::kLines : PrimitiveParts::kTriangles;
}

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

void turn_over(std::vector<uint32_t>& corners) {
  for (size_t t = 0; t + 2 < corners.size(); t += 3) std::swap(corners[t + 1], corners[t + 2]);
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

MorphTarget read_morph_target(GltfDocument& document, const JsonView& target, size_t vertices,
                              const std::vector<uint32_t>& used) {
  return {gather_vec3(document, target, "POSITION", vertices, used), gather_vec3(document, target, "NORMAL", vertices, used),
          gather_vec3(document, target, "TANGENT", vertices, used)};
}

// Targets that no axis drives and that have no weight at rest stay empty.
std::vector<MorphTarget> read_morph_targets(GltfDocument& document, const JsonView& place, const std::vector<float>& weights,
                                            bool driven, size_t vertices, const std::vector<uint32_t>& used) {
  const auto targets = place.find("targets");
  if (!targets || weights.empty()) return {};
  if (weights.size() != targets->size())
    targets->fail(fmt::format("there are {} targets, but {} weights", targets->size(), weights.size()));
  std::vector<MorphTarget> read(weights.size());
  for (size_t t = 0; t < weights.size(); ++t)
    if (driven || weights[t] != 0) read[t] = read_morph_target(document, (*targets)[t], vertices, used);
  return read;
}

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

// On which of `joints` joints the used vertices hang; a joint without weight need not be one of them.
void read_influences(GltfDocument& document, const JsonView& attributes, size_t joints, size_t vertices,
                     const std::vector<uint32_t>& used, MeshPrimitive& primitive) {
  const std::vector<SkinSet> sets = open_skin_sets(document, attributes, vertices);
  primitive.influences_per_vertex = 4 * sets.size();
  document.charge(used.size() * primitive.influences_per_vertex * sizeof(SkinInfluence), attributes);
  primitive.influences.reserve(used.size() * primitive.influences_per_vertex);
  for (const uint32_t vertex : used)
    for (const SkinSet& set : sets)
      for (int c = 0; c < 4; ++c) {
        const float weight = set.weights.value(vertex, c);
        const uint32_t joint = weight == 0 ? 0 : set.joints.integer(vertex, c);
        if (joint >= joints)
          attributes.fail(fmt::format("vertex {} hangs on joint {}, but its skin has {}", vertex, joint, joints));
        primitive.influences.push_back({joint, weight});
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

// The materials' textures need coordinates, and a normal map tangents.
void GltfMeshes::prepare_for_textures(const JsonView& place, MeshPrimitive& primitive, Geometry& g) {
  const TextureRef* normal_map = nullptr;
  for (const int m : primitive.materials) {
    const Material& material = (*scene_materials_)[static_cast<size_t>(m)];
    if (!normal_map) normal_map = normal_map_of(material);
    for_textures(material, [&](const TextureRef& ref) {
      const size_t set = static_cast<size_t>(ref.texcoord);
      if (!g.texcoords[set].empty() || !primitive.vertices.texcoords[set].empty()) return;  // lines may all be points at rest
      document_.warn(fmt::format("{} has a texture but no TEXCOORD_{}; (0, 0) is taken", place.where(), ref.texcoord));
      g.texcoords[set].assign(g.positions.size(), glm::vec2(0));
      primitive.vertices.texcoords[set].assign(primitive.vertices.positions.size(), glm::vec2(0));
    });
  }
  if (!normal_map) return;
  primitive.tangent_texcoord = normal_map->texcoord;
  primitive.tangent_transform = normal_map->transform;
}

std::optional<MeshPrimitive> GltfMeshes::read_vertices(const JsonView& place, const std::vector<float>& weights,
                                                       const MeshInstance& instance) {
  const int64_t mode = place.integer_or("mode", kTriangles, kPoints, kTriangleFan);
  const JsonView attributes = place.at("attributes");
  const auto position = attributes.find("POSITION");
  document_.charge(kPrimitiveCharge, place);
  if (!position) {
    document_.warn(place.where() + " has no positions and is not shown");
    return std::nullopt;
  }
  const size_t vertices = open_accessor(document_, *position, 3, 3).size();
  MeshPrimitive primitive;
  primitive.place = document_.file() + ": " + printable(place.where(), 200);
  primitive.parts = parts_of_mode(mode);
  primitive.vertices.indices = read_corners(place, vertices, mode);
  if (primitive.vertices.indices.empty()) return std::nullopt;
  if (instance.mirrored && mode >= kTriangles) turn_over(primitive.vertices.indices);
  const std::vector<uint32_t> used = compact(primitive.vertices.indices);
  charge(used.size(), 0, place);
  gather_attributes(document_, attributes, vertices, used, primitive.vertices);
  primitive.targets = read_morph_targets(document_, place, weights, instance.weights_are_driven, vertices, used);
  if (!instance.skin.joints.empty())
    read_influences(document_, attributes, instance.skin.joints.size(), vertices, used, primitive);
  return primitive;
}

void GltfMeshes::read_primitive(const JsonView& place, const MeshPose& rest, const MeshInstance& instance, DeformedMesh& mesh,
                                Deformation* deformation) {
  std::optional<MeshPrimitive> primitive = read_vertices(place, rest.weights, instance);
  if (!primitive) return;
  Geometry g = deformation ? primitive->vertices : std::move(primitive->vertices);
  const bool flat = g.normals.empty() || primitive->parts != PrimitiveParts::kTriangles;
  shape_primitive(*primitive, rest, g);
  if (g.indices.empty() && !deformation) return;  // else it may be seen at another pose
  if (flat) charge(g.positions.size(), 0, place);
  primitive->materials = materials_of(place);
  prepare_for_textures(place, *primitive, g);
  if (!g.indices.empty()) {
    add_tangents(*primitive, g);
    append_primitive(*primitive, std::move(g), mesh);
  }
  if (deformation) deformation->primitives.push_back(std::move(*primitive));
}

std::vector<float> GltfMeshes::rest_weights(const JsonView& mesh, const MeshInstance& instance) const {
  std::vector<float> weights = instance.weights;
  if (const auto own = mesh.find("weights"); own && weights.empty()) {
    weights.resize(own->size());
    own->numbers(weights, -1e6, 1e6);
  }
  if (!instance.weights_are_driven) return weights;
  const size_t targets = morph_target_count(mesh);
  if (weights.empty()) weights.resize(targets, 0.0f);
  if (weights.size() != targets) mesh.fail(fmt::format("there are {} targets, but {} weights", targets, weights.size()));
  return weights;
}

bool GltfMeshes::read(const MeshInstance& instance, Object& object) {
  const JsonView mesh = document_.element("meshes", instance.mesh);
  const MeshPose rest{rest_weights(mesh, instance), instance.skin.world_from_bind};
  std::shared_ptr<Deformation> deformation;
  if (instance.weights_are_driven || instance.joints_are_moved)
    deformation = std::make_shared<Deformation>(Deformation{{}, rest.weights, instance.skin.joints});
  DeformedMesh at_rest;
  at_rest.variant_materials.resize(variants_.size());
  const JsonView primitives = mesh.at("primitives");
  for (size_t p = 0; p < primitives.size(); ++p) read_primitive(primitives[p], rest, instance, at_rest, deformation.get());
  const bool same = std::all_of(at_rest.variant_materials.begin(), at_rest.variant_materials.end(),
                                [&](const std::vector<int>& m) { return m == at_rest.geometry.triangle_materials; });
  if (same && !deformation) at_rest.variant_materials.clear();
  object.geometry = std::move(at_rest.geometry);
  object.variant_materials = std::move(at_rest.variant_materials);
  const bool shown = deformation ? !deformation->primitives.empty() : !object.geometry.indices.empty();
  object.deformation = std::move(deformation);
  if (!shown) document_.warn(mesh.where() + " has nothing to show");
  return shown;
}

size_t morph_target_count(const JsonView& mesh) {
  const JsonView primitives = mesh.at("primitives");
  for (size_t p = 0; p < primitives.size(); ++p)
    if (const auto targets = primitives[p].find("targets")) return targets->size();
  return 0;
}

}  // namespace vitrine
