// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Mistakes of the user: an input file that is wrong, an option that cannot be met. tools/ prints them as
//   vitrine: FILE: what is wrong: what to do
// on one line and ends with exit code 1.
#pragma once

#include <stdexcept>
#include <string>

namespace vitrine {

class InputError : public std::runtime_error {
 public:
  // `file`: the offending file (with the key, node or line after it where that helps, as "scene.toml: axis 2").
  InputError(std::string file, std::string problem, std::string remedy)
      : std::runtime_error(file + ": " + problem + ": " + remedy) {}
};

}  // namespace vitrine
