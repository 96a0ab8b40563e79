// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "formats/image.h"

namespace vitrine {

// One self-contained HTML page: axes, plan, and a bar of bytes for every object, layer and level. `summary` is what
// vitrine inspect --json prints. Throws InputError where the file cannot be written.
void write_inspect_report(const std::filesystem::path& file, const std::string& image_name, const ImageView& image, const nlohmann::json& summary);

}  // namespace vitrine
