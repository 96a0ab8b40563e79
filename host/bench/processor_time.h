// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Clocks of benchmarks.
#pragma once

#include <chrono>
#include <ctime>

namespace vitrine {

// Seconds that all threads of the process have run: others' work on the machine hardly counts.
inline double processor_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

inline double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace vitrine
