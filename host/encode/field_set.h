// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// All fields that share one storage target, and passes over them at a given price.
#pragma once

#include <vector>

#include "host/base/progress.h"
#include "host/encode/encode.h"
#include "host/encode/field_coder.h"

namespace vitrine {

// One field and how it is to be coded.
struct FieldJob {
  const FieldSource* source = nullptr;
  FieldShape shape;  // its pyramid is that of `setting`
  FieldSetting setting;
  double weight = 1;       // of its errors
  FieldTextures textures;  // all of it
  FieldTextures preview;   // some rows of tiles of every texture; empty: `textures` serves
  const FieldTextures& preview_textures() const { return preview.width > 0 ? preview : textures; }
  double preview_share() const { return static_cast<double>(preview_textures().height) / textures.height; }
  void set_pyramid(const PyramidShape& pyramid);
  // Squared error per bit for this field, where that of a field of weight 1 is `price`.
  double own(double price) const { return price / weight; }
};

// Loads every texture once; keeps them where memory allows. Previews hold about kPreviewTexels leaf texels in all.
std::vector<FieldJob> load_fields(const std::vector<FieldSource>& fields, Progress& progress);

struct FieldPass {
  std::vector<CodedBlock> blocks;
  double bytes = 0;          // of the nodes
  double squared_error = 0;  // importance-weighted, as EncodedField
  double share = 1;          // of the texels, that were coded: below 1 for previews
};
struct Pass {
  std::vector<FieldPass> fields;
  double bytes = 0;  // nodes, contexts and tables, as EncodedField::bytes
};
// Codes everything at a price (squared error per bit); previews are scaled up to the size of the whole.
Pass encode_pass(const std::vector<FieldJob>& jobs, double price, bool preview, Progress& progress);

// Contexts of every level from the symbols of a pass.
void train_contexts(std::vector<FieldJob>& jobs, const Pass& pass);

// What a node takes in the directory, which is compressed: about what was seen of scenes.
inline constexpr double kNodeTableBytes = 3;
// What the tables take beside the nodes.
double table_bytes(const FieldJob& job);

}  // namespace vitrine
