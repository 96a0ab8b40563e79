// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Meshes that change their shape: morph targets, then skins (glTF 2.0, sections 3.7.2.2 and 3.7.3.3). An object that an axis
// deforms keeps what its mesh was made from, and its mesh is made anew for every pose by the same steps as the loader's: the
// picture is that of a file with the pose baked in. This is the host's alone: the target draws rigid meshes.
#pragma once

#include <glm/mat4x4.hpp>
#include <string>
#include <vector>

#include "host/scene/scene.h"

namespace vitrine {

// Displacements per vertex; arrays that the target lacks are empty.
struct MorphTarget {
  std::vector<glm::vec3> positions, normals, tangents;
};

struct SkinInfluence {
  uint32_t joint = 0;  // index into Deformation::joints, always within it
  float weight = 0;
};

struct SkinJoint {
  int node = -1;                // rig node; -1: none, it stands still
  glm::mat4 node_from_bind{1};  // inverse bind matrix; where the node is -1, world from bind space
};

// What the vertices of a primitive make: points, lines (both become thin solids) or triangles.
enum class PrimitiveParts : uint8_t { kPoints, kLines, kTriangles };

// One glTF primitive before morph targets and skin.
struct MeshPrimitive {
  std::string place;  // in the file, for errors
  PrimitiveParts parts = PrimitiveParts::kTriangles;
  // As the file gives them; normals and tangents may be absent. Indices: 1, 2 or 3 per part. No triangle_materials.
  Geometry vertices;
  std::vector<MorphTarget> targets;       // parallel to the weights; empty where none moves anything
  std::vector<SkinInfluence> influences;  // per vertex `influences_per_vertex` of them; empty: not skinned
  size_t influences_per_vertex = 0;
  std::vector<int> materials;  // its own, then one per value of the variants axis
  int tangent_texcoord = -1;   // texture coordinates that generated tangents follow; -1: no normal map
  glm::mat3 tangent_transform{1};
};

// What the mesh of an object is made from.
struct Deformation {
  std::vector<MeshPrimitive> primitives;
  std::vector<float> weights;  // of the morph targets at rest
  std::vector<SkinJoint> joints;
};

// What a pose means to a mesh.
struct MeshPose {
  std::vector<float> weights;              // per morph target
  std::vector<glm::mat4> world_from_bind;  // per joint
};
MeshPose mesh_pose(const Scene& scene, const Pose& pose, int object);

// A mesh at one pose. Its triangles need not be those of another pose: triangles without area are left out.
struct DeformedMesh {
  Geometry geometry;                                // in the space of the object's node
  std::vector<std::vector<int>> variant_materials;  // per value of the variants axis, a replacement of triangle_materials
};

// The mesh of an object that has a deformation, with all that shading needs. Throws InputError where a vertex leaves the
// range of coordinates.
DeformedMesh deformed_mesh(const Scene& scene, const Pose& pose, int object);
// Its positions and triangles only: for bounds.
Geometry deformed_shape(const Scene& scene, const Pose& pose, int object);
// Numbers that one call of deformed_shape reads: a measure of its time.
size_t deformation_work(const Deformation& deformation);

// The steps of the loader. Turns the vertices of a primitive into triangles: morphs and skins them, makes thin solids of
// points and lines, drops what has no area, and gives every vertex a normal. `g` holds primitive.vertices, which need not be
// there any more. No triangles remain where there is nothing to show.
void shape_primitive(const MeshPrimitive& primitive, const MeshPose& pose, Geometry& g);
// The file's tangents repaired, or those of the normal map.
void add_tangents(const MeshPrimitive& primitive, Geometry& g);
// Appends a primitive's triangles with their materials.
void append_primitive(const MeshPrimitive& primitive, Geometry g, DeformedMesh& mesh);

// Weights of morph targets at a position; as many as the track's values have per key.
std::vector<float> sample_weights(const WeightTrack& track, const Position& position);
// The axes that deform an object; 0 for one that is rigid.
AxisMask deforming_axes(const Scene& scene, int object);

}  // namespace vitrine
