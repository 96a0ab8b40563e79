// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// What the HTML pages of reports share.
#pragma once

#include <filesystem>
#include <string>

namespace vitrine {

// Rules for tables with numbers in cells of class n.
extern const char* const kPageStyle;

std::string html_escaped(const std::string& text);

// A page, or a picture (SVG) for one. Throws InputError where the file cannot be written.
void write_page(const std::filesystem::path& file, const std::string& html);

}  // namespace vitrine
