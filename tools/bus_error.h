// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Images are mapped, not read: one that is cut short or written over while it is in use, or lies on a medium that fails, ends
// in SIGBUS. The user gets a line and exit code 1 instead of a core dump.
#pragma once

#include <string>

namespace vitrine {

// From here on, for `file`, by the name of `program`. Once per process.
void explain_bus_errors(const std::string& program, const std::string& file);

}  // namespace vitrine
