// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// A command line that says nothing sensible: printed on one line, with the help to look at; exit code 2.
#pragma once

#include <stdexcept>

namespace vitrine {

struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace vitrine
