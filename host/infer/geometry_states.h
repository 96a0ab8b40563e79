// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Where the drawn objects stand on the screen at a grid sample.
#pragma once

#include <cstdint>
#include <span>

#include "host/infer/inference.h"
#include "host/infer/test_renderer.h"
#include "host/scene/scene.h"

namespace vitrine {

GeometryState geometry_state_at(const Scene& scene, int64_t grid_sample, std::span<const DrawnObject> objects, float aspect);

}  // namespace vitrine
