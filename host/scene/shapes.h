// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Meshes that the loader makes by itself.
#pragma once

#include "host/scene/scene.h"

namespace vitrine {

// A sphere around the origin in lat-long quads, its triangles facing outwards (counter-clockwise from outside), with the
// lat-long coordinates of latlong_from_direction; `columns` around and `rows` from pole to pole. No materials yet.
Geometry make_sphere(float radius, int columns, int rows);
// The same, facing inwards: the dome that carries the backdrop. The faces' planes come as near as
// `radius * dome_inner_radius(columns, rows)` to the centre.
Geometry make_dome(float radius, int columns, int rows);
float dome_inner_radius(int columns, int rows);
// An axis-aligned box around the origin, flat normals; each side has a cell of its own in a 3 x 2 atlas.
Geometry make_box(const glm::vec3& size);

}  // namespace vitrine
