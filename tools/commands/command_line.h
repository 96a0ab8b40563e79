// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// The command line of vitrine.
#pragma once

#include <functional>

namespace vitrine {

// The command that was asked for, to be run; empty when it was for help, which is printed. Throws UsageError.
std::function<void()> parse_command_line(int argc, char** argv);

}  // namespace vitrine
