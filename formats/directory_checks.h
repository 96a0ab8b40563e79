// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Range checks of an image's directory, one per rule of formats/SPEC.md. The FlatBuffers verifier has passed; these see to
// every number. Used by ImageView::open alone.
#pragma once

#include "formats/block.h"
#include "formats/status.h"
#include "image_generated.h"

namespace vitrine {

// Everything but where the sections lie. Time is bounded by the size of the directory and the limits of image.h, however the
// directory's offsets overlap.
Status check_directory(const fb::Image& image);

// Views of the directory in the types of formats/. Only for values that check_directory has passed or is about to judge.
ParameterSpace space_from_directory(const fb::Image& image);
FieldShape shape_from_directory(const fb::Image& image, const fb::Field& field);

}  // namespace vitrine
