// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace vitrine::hal {

// Monotonic time and frame pacing.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual int64_t now_ns() = 0;
  virtual void sleep_until(int64_t time_ns) = 0;  // returns at once where that is past
};

}  // namespace vitrine::hal
