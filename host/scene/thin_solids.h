// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Points and lines (glTF 2.0, section 3.7.2.1) as solids that a path can hit: glTF gives them no thickness, screens draw them
// a pixel or so wide. A line becomes a square rod, a point an octahedron, thin against the primitive that they belong to.
#pragma once

#include "host/scene/scene.h"

namespace vitrine {

inline constexpr size_t kTrianglesOfRod = 12, kTrianglesOfPoint = 8;

// geometry.indices are pairs of vertices, the ends of lines; lines without length make nothing. Afterwards they are triangles,
// counter-clockwise from outside; normals and tangents are gone, all else comes from the nearer end.
void make_rods(Geometry& geometry);
// geometry.indices are points.
void make_octahedra(Geometry& geometry);

}  // namespace vitrine
