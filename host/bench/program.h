// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Other programs, run as children: what a benchmark compares with.
#pragma once

#include <string>
#include <vector>

namespace vitrine {

struct ProgramRun {
  int exit_code = 0;       // 128 + N where signal N ended it
  double cpu_seconds = 0;  // of the child, user and system
  std::string output;      // what it wrote on its standard output and error
};

// Runs arguments[0], found along PATH, without a shell and with nothing to read; waits for it. Throws InputError where it cannot
// be started.
ProgramRun run_program(const std::vector<std::string>& arguments);

}  // namespace vitrine
