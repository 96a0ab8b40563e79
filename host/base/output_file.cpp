// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/base/output_file.h"

#include "host/base/error.h"

namespace vitrine {

void check_output_file(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (std::filesystem::is_directory(file)) throw InputError(file.string(), "it is a folder", "give the file another name");
  if (!std::filesystem::is_directory(folder)) throw InputError(file.string(), "its folder does not exist", "make the folder first");
}

}  // namespace vitrine
