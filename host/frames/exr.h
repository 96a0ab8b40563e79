// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Multi-part OpenEXR in memory, as far as the store needs it: scan lines, half floats, ZIP.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace vitrine {

// One channel of a part; values in rows, top first.
struct ExrChannel {
  std::string name;
  std::vector<float> values;
};

struct ExrPart {
  std::string name;
  int tag = -1;                             // attribute "vitrineObject": what the part is about, whatever its name
  int x = 0, y = 0, width = 0, height = 0;  // data window, at least 1 x 1
  std::vector<ExrChannel> channels;         // names are unique; attribute "vitrineChannels" keeps their order
};

struct ExrFile {
  int width = 0, height = 0;   // display window
  std::vector<ExrPart> parts;  // names are unique
};

// Values beyond the range of half are clamped to it, NaN becomes 0.
std::string encode_exr(const ExrFile& file);

// What encode_exr wrote, or nothing if anything is wrong with it. Trusts no size in it.
std::optional<ExrFile> decode_exr(const std::string& bytes);

}  // namespace vitrine
