// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <time.h>

#include <algorithm>
#include <cerrno>

#include "hal/backends.h"

namespace vitrine::hal {
namespace {

constexpr int64_t kSecond = 1'000'000'000;

class PosixClock final : public Clock {
 public:
  int64_t now_ns() override {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<int64_t>(now.tv_sec) * kSecond + now.tv_nsec;
  }
  void sleep_until(int64_t time_ns) override {
    if (time_ns <= now_ns()) return;
    const timespec until{static_cast<time_t>(time_ns / kSecond), static_cast<long>(time_ns % kSecond)};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);  // a signal ends it early: the caller looks at its flags
  }
};

class VirtualClock final : public Clock {
 public:
  int64_t now_ns() override { return now_; }
  void sleep_until(int64_t time_ns) override { now_ = std::max(now_, time_ns); }

 private:
  int64_t now_ = 0;
};

}  // namespace

std::unique_ptr<Clock> create_posix_clock() { return std::make_unique<PosixClock>(); }
std::unique_ptr<Clock> create_virtual_clock() { return std::make_unique<VirtualClock>(); }

}  // namespace vitrine::hal
