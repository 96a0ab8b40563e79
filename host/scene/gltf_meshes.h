// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Meshes (glTF 2.0, section 3.7): primitives of a mesh become the triangles of one object, points and lines as thin solids.
// Vertices that no part uses are left out, strips and fans are cut into triangles, triangles without area are dropped, morph
// targets and skins are applied in their rest state. Of a mesh that an axis deforms, what it is made from is kept as well.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/scene/deformation.h"
#include "host/scene/gltf_document.h"
#include "host/scene/gltf_materials.h"
#include "host/scene/gltf_nodes.h"
#include "host/scene/scene.h"

namespace vitrine {

inline constexpr size_t kMostSceneVertices = 20'000'000;
inline constexpr size_t kMostSceneTriangles = 20'000'000;

// What a node adds to its mesh.
struct MeshInstance {
  int mesh = 0;
  std::vector<float> weights;       // of the node; empty: those of the mesh
  GltfSkin skin;                    // without joints: not skinned
  bool mirrored = false;            // skinned, below transforms that mirror: triangles have their fronts on the other side
  bool weights_are_driven = false;  // by an axis
  bool joints_are_moved = false;    // by an axis
};

// Number of morph targets of a mesh's primitives.
size_t morph_target_count(const JsonView& mesh);

class GltfMeshes {
 public:
  // `variants`: indices of the material variants (of KHR_materials_variants) that the scene asks for.
  GltfMeshes(GltfDocument& document, GltfMaterials& materials, std::vector<Material>* scene_materials, std::vector<int> variants)
      : document_(document), materials_(materials), scene_materials_(scene_materials), variants_(std::move(variants)) {}

  // Fills geometry, variant_materials and deformation. False where nothing of the mesh is a triangle (said in a warning).
  bool read(const MeshInstance& instance, Object& object);

 private:
  // `deformation`: null for a mesh that no axis deforms.
  void read_primitive(const JsonView& place, const MeshPose& rest, const MeshInstance& instance, DeformedMesh& mesh,
                      Deformation* deformation);
  std::optional<MeshPrimitive> read_vertices(const JsonView& place, const std::vector<float>& weights,
                                             const MeshInstance& instance);
  void prepare_for_textures(const JsonView& place, MeshPrimitive& primitive, Geometry& g);
  std::vector<float> rest_weights(const JsonView& mesh, const MeshInstance& instance) const;
  std::vector<uint32_t> read_corners(const JsonView& place, size_t vertices, int64_t mode);
  std::vector<int> materials_of(const JsonView& place);
  void charge(size_t vertices, size_t triangles, const JsonView& place);

  GltfDocument& document_;
  GltfMaterials& materials_;
  std::vector<Material>* scene_materials_;
  std::vector<int> variants_;
  size_t vertices_ = 0, triangles_ = 0;
};

}  // namespace vitrine
