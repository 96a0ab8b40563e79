// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Meshes on the grid on which images hold them. They are laid there before anything is inferred, so that textures are made
// for the surface that will be drawn.
#pragma once

#include <span>

#include "formats/mesh.h"

namespace vitrine {

// A cube of 2^16 steps over the vertices.
MeshGrid grid_over(std::span<const MeshVertex> vertices);
// Texture coordinates are those in [0, 1] of a patch.
GridVertex nearest_on_grid(const MeshGrid& grid, const MeshVertex& vertex);
MeshVertex laid_on_grid(const MeshGrid& grid, const MeshVertex& vertex);
// Moves each vertex to the nearest place of the grid over all; once there they stay.
MeshGrid lay_on_grid(std::span<MeshVertex> vertices);

}  // namespace vitrine
