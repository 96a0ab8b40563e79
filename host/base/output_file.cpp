// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/base/output_file.h"

#include <unistd.h>

#include "host/base/error.h"

namespace vitrine {

void check_output_file(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) throw InputError(file.string(), "it is a folder", "give the file another name");
  if (!std::filesystem::is_directory(folder, error)) throw InputError(file.string(), "its folder does not exist", "make the folder first");
  if (std::filesystem::exists(file, error) && !std::filesystem::is_regular_file(file, error))
    throw InputError(file.string(), "it is not a regular file", "give the file another name");
  if (::access(folder.c_str(), W_OK | X_OK) != 0) throw InputError(file.string(), "there is no permission to write there", "name another folder or change its permissions");
}

}  // namespace vitrine
