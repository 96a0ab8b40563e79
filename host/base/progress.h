// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Progress of long work, and its clean interruption. Thread-safe.
#pragma once

#include <cstdint>
#include <stdexcept>

namespace vitrine {

// Thrown by Progress::advance once Ctrl-C was pressed: stages unwind, leaving their stores consistent; the same command
// goes on later. tools/ ends with exit code 130.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("interrupted: run the same command again") {}
};

class Progress {
 public:
  virtual ~Progress() = default;
  // A stage begins: `total` steps named `unit` (plural), of which `already` need no work.
  virtual void begin(const char* stage, int64_t total, int64_t already, const char* unit) = 0;
  virtual void advance(int64_t steps) = 0;  // throws Interrupted; 0 steps: only for that
  virtual void end() = 0;
};

// Says nothing and is never interrupted.
Progress& silent_progress();

// For a part of one step of `whole`: passes interruption on, and no steps.
class PartOfStep final : public Progress {
 public:
  explicit PartOfStep(Progress& whole) : whole_(whole) {}
  void begin(const char*, int64_t, int64_t, const char*) override {}
  void advance(int64_t) override { whole_.advance(0); }
  void end() override {}

 private:
  Progress& whole_;
};

}  // namespace vitrine
