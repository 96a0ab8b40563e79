// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Operations on triangle meshes that glTF asks of a reader (glTF 2.0, section 3.7.2.1).
#pragma once

#include "host/scene/scene.h"

namespace vitrine {

// Takes out triangles with two equal corners or without area. Returns how many went.
size_t drop_degenerate_triangles(Geometry& geometry);
// Every triangle gets three vertices of its own and its own normal (counter-clockwise is outside).
void make_flat_normals(Geometry& geometry);
// Normals to unit length; those without one become the mean of the adjacent triangles' normals, weighted by area.
void repair_normals(Geometry& geometry);
// Tangents for a normal map, as MikkTSpace makes them (Mikkelsen 2008, "Simulation of Wrinkled Surfaces Revisited"): per
// corner the direction in which u grows, summed over the corners that share position, normal, texture coordinates and
// handedness, weighted by the corner's angle. Vertices that lie in two such groups are doubled. w is -1 where the texture
// is mirrored; the bitangent is cross(normal, tangent) * w, along which v falls as glTF defines it: the picture's up.
void make_tangents(Geometry& geometry, int texcoord, const glm::mat3& transform);
// Appends `more`, filling the attributes that only one of them has: colour white, texture coordinates and tangents zero.
void append_geometry(Geometry& geometry, const Geometry& more);

}  // namespace vitrine
