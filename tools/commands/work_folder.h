// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace vitrine {

// A folder that goes away again, or one that was named and stays.
class WorkFolder {
 public:
  explicit WorkFolder(const std::string& named) : kept_(!named.empty()) {
    path_ =
        kept_ ? std::filesystem::path(named) : std::filesystem::temp_directory_path() / fmt::format("vitrine-bench-{}", getpid());
  }
  ~WorkFolder() {
    std::error_code ignored;
    if (!kept_) std::filesystem::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  bool kept_;
  std::filesystem::path path_;
};

}  // namespace vitrine
