// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "tools/commands/contact_sheet.h"

#include <algorithm>

#include "host/base/error.h"
#include "tools/png.h"

namespace vitrine {
namespace {

constexpr int kGap = 4;

void paste(Picture& sheet, const Picture& picture, int x, int y) {
  for (int row = 0; row < picture.height; ++row) {
    const auto* first = picture.rgb.data() + static_cast<size_t>(row) * picture.width * 3;
    std::copy(first, first + static_cast<size_t>(picture.width) * 3, sheet.rgb.begin() + (static_cast<size_t>(y + row) * sheet.width + x) * 3);
  }
}

Picture difference(const Picture& a, const Picture& b) {
  Picture result = a;
  for (size_t i = 0; i < a.rgb.size(); ++i) result.rgb[i] = static_cast<uint8_t>(std::clamp(128 + 8 * (b.rgb[i] - a.rgb[i]), 0, 255));
  return result;
}

}  // namespace

void write_contact_sheet(const std::filesystem::path& file, const std::vector<Comparison>& comparisons) {
  const int rows = std::min<int>(kSheetRows, static_cast<int>(comparisons.size()));
  if (rows == 0) return;
  const int width = comparisons[0].truth.width, height = comparisons[0].truth.height;
  Picture sheet{3 * width + 2 * kGap, rows * (height + kGap) - kGap, {}};
  sheet.rgb.assign(static_cast<size_t>(sheet.width) * sheet.height * 3, 255);
  for (int row = 0; row < rows; ++row) {
    const int y = row * (height + kGap);
    paste(sheet, comparisons[row].truth, 0, y);
    paste(sheet, comparisons[row].played, width + kGap, y);
    paste(sheet, difference(comparisons[row].truth, comparisons[row].played), 2 * (width + kGap), y);
  }
  const Status status = write_png(file.string(), sheet.width, sheet.height, sheet.rgb);
  if (!status.ok()) throw InputError(file.string(), status.detail(), "check that the folder exists and has room");
}

}  // namespace vitrine
