// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Results go to standard output. One that did not arrive, on a full disk or a closed pipe, must not look like success to the
// script that reads the exit code.
#pragma once

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>

namespace vitrine {

struct StandardOutputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Writes what is still buffered. Throws StandardOutputError when that or any earlier write failed.
inline void finish_standard_output() {
  const bool failed = std::ferror(stdout) != 0;
  if (std::fflush(stdout) != 0 || failed)
    throw StandardOutputError(std::string("standard output: it could not be written (") + std::strerror(errno) + "): make room or redirect it elsewhere");
}

}  // namespace vitrine
