// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The pictures that an image's nodes carry: what the encoder was given, found again from the textures in the store and the
// decoded coarser levels.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "formats/image.h"
#include "host/base/progress.h"
#include "host/encode/encode.h"
#include "host/frames/store.h"
#include "host/infer/inference.h"
#include "target/decode/node_decoder.h"

namespace vitrine {

struct NodePicture {
  NodeDesc desc;
  std::span<const std::byte> bytes;  // as the image holds it; never empty
  CodedPlanes source;                // what it stands for: mean of the leaves of its cell, less the decoded coarser levels
  size_t texels() const { return static_cast<size_t>(desc.width) * static_cast<size_t>(desc.height); }
};

struct NodePictures {
  std::vector<std::vector<uint8_t>> contexts;  // by field, to which the nodes' descriptions point
  std::vector<NodePicture> nodes;
};

// Of all nodes that have bytes, in the order in which the image holds them. `inference`: of the scene that the image was
// compiled from. Throws InputError where the image is of another scene, or damaged. Bytes point into the image.
NodePictures node_pictures(const ImageView& image, const Inference& inference, const Store& store, Progress& progress);

}  // namespace vitrine
