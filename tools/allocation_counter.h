// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Counts what the frame loop allocates: every operator new of this thread while a count is open, except inside the device
// (a GL driver allocates as it likes).
#pragma once

#include <cstdint>
#include <memory>

#include "hal/gpu.h"

namespace vitrine {

int64_t allocations_counted();

class CountAllocations {
 public:
  CountAllocations();
  ~CountAllocations();
  CountAllocations(const CountAllocations&) = delete;
  CountAllocations& operator=(const CountAllocations&) = delete;
};

// The same device; what it allocates itself is not counted.
std::unique_ptr<hal::Gpu> uncounted(std::unique_ptr<hal::Gpu> gpu);

}  // namespace vitrine
