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

void write_picture_rows(const std::filesystem::path& file, const std::vector<std::vector<Picture>>& rows) {
  if (rows.empty()) return;
  const int width = rows[0].at(0).width, height = rows[0].at(0).height;
  size_t columns = 0;
  for (const auto& row : rows) columns = std::max(columns, row.size());
  Picture sheet{static_cast<int>(columns) * (width + kGap) - kGap, static_cast<int>(rows.size()) * (height + kGap) - kGap, {}};
  sheet.rgb.assign(static_cast<size_t>(sheet.width) * sheet.height * 3, 255);
  for (size_t row = 0; row < rows.size(); ++row)
    for (size_t column = 0; column < rows[row].size(); ++column)
      paste(sheet, rows[row][column], static_cast<int>(column) * (width + kGap), static_cast<int>(row) * (height + kGap));
  const Status status = write_png(file.string(), sheet.width, sheet.height, sheet.rgb);
  if (!status.ok()) throw InputError(file.string(), status.detail(), "check that the folder exists and has room");
}

Picture magnified(const Picture& picture, int factor) {
  Picture large{picture.width * factor, picture.height * factor, {}};
  large.rgb.reserve(static_cast<size_t>(large.width) * large.height * 3);
  for (int y = 0; y < large.height; ++y)
    for (int x = 0; x < large.width; ++x) {
      const uint8_t* pixel = &picture.rgb[(static_cast<size_t>(y / factor) * picture.width + x / factor) * 3];
      large.rgb.insert(large.rgb.end(), pixel, pixel + 3);
    }
  return large;
}

void write_contact_sheet(const std::filesystem::path& file, const std::vector<Comparison>& comparisons) {
  std::vector<std::vector<Picture>> rows;
  for (size_t row = 0; row < std::min<size_t>(kSheetRows, comparisons.size()); ++row) {
    const Comparison& c = comparisons[row];
    rows.push_back({c.truth, c.played, difference(c.truth, c.played)});
  }
  write_picture_rows(file, rows);
}

}  // namespace vitrine
