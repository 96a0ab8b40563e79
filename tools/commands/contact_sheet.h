// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "host/verify/verify.h"

namespace vitrine {

// One PNG of pictures side by side, row by row, all of one size; white between them. Throws InputError.
void write_picture_rows(const std::filesystem::path& file, const std::vector<std::vector<Picture>>& rows);
// Every pixel as a square of `factor` x `factor`.
Picture magnified(const Picture& picture, int factor);

// One PNG: a row per comparison (at most kSheetRows), in each ground truth, playback, and their difference times 8 around grey.
inline constexpr int kSheetRows = 8;
void write_contact_sheet(const std::filesystem::path& file, const std::vector<Comparison>& comparisons);

}  // namespace vitrine
