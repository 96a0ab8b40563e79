// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Links meshes, rig, coded fields and plan into one image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/encode/encode.h"
#include "host/infer/inference.h"
#include "host/plan/plan.h"
#include "host/scene/scene.h"

namespace vitrine {

struct LinkInput {
  const Scene* scene = nullptr;
  int width = 0, height = 0, supersampling = 2;
  SurfaceFilter filter = SurfaceFilter::kTrilinear;  // for which the textures were inferred
  const Inference* inference = nullptr;
  const std::vector<EncodedField>* encoded = nullptr;  // parallel to inference->fields
  Plan plan;
  uint64_t frames_key = 0;  // of what the frames depend on
};

// An object's mesh as an image holds it.
struct MeshSection {
  std::vector<std::byte> bytes;
  uint32_t vertex_count = 0, coded_vertex_bytes = 0, coded_index_bytes = 0;
};
MeshSection mesh_section(const DrawnObject& object);

// The bytes of the image: deterministic, and ImageView::open accepts them.
std::vector<std::byte> link_image(const LinkInput& input);

}  // namespace vitrine
