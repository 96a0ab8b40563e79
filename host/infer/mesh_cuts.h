// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "host/infer/inference.h"
#include "host/infer/visible_surface.h"

namespace vitrine {

// The same surface, cut along the borders of all patches; patch k's coordinates are raised by k * kPatchStep in u. Triangles that
// share an edge and its coordinates stay without a gap.
DrawnObject cut_into_patches(const DrawnObject& object, std::span<const DomainPart> patches);

}  // namespace vitrine
