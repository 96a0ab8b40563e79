// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The meshes of an image (formats/SPEC.md): vertices with the texture coordinates of the object's own texture domain, 32-bit
// indices.
#pragma once

#include <cstdint>
#include <span>

#include "formats/status.h"

namespace vitrine {

class ImageView;
namespace fb {
struct Object;
}

struct MeshVertex {
  float x, y, z, u, v;
};

// Decodes into the caller's arrays of exactly the counts that the object declares; fails on damaged data or an index out of
// range.
Status decode_mesh(const ImageView& image, const fb::Object& object, std::span<MeshVertex> vertices, std::span<uint32_t> indices);

}  // namespace vitrine
