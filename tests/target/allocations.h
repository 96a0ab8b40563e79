// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace vitrine::test {

// Calls of malloc and its kin in this program so far (0 under a sanitizer, which has its own).
int64_t allocations();

}  // namespace vitrine::test
