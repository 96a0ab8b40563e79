// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Progress for people. On a terminal one line per stage, redrawn in place with rate and time left; elsewhere (a log, a pipe)
// a plain line at every tenth of a stage (but at most one a second) or every ten seconds, and one at its end.
#pragma once

#include <chrono>
#include <cstdio>
#include <functional>
#include <mutex>
#include <string>

#include "host/base/progress.h"

namespace vitrine {

class TerminalProgress final : public Progress {
 public:
  using Clock = std::function<double()>;  // seconds, monotonic

  // Writes to `out` (stderr in tools: stdout is for results). `redraw`: `out` is a terminal. `clock` is replaced by tests.
  TerminalProgress(std::FILE* out, bool redraw, Clock clock = {});
  ~TerminalProgress() override;

  void begin(const char* stage, int64_t total, int64_t already, const char* unit) override;
  // Thread-safe. Throws Interrupted once interrupt_requested() (host/base/interrupt.h).
  void advance(int64_t steps) override;
  void end() override;

 private:
  void show(double now, bool last);
  bool is_due(double now) const;
  void write_line(const std::string& line, bool last);
  void finish();
  void write(const std::string& text);

  std::FILE* out_;
  bool redraw_;
  Clock clock_;
  std::mutex mutex_;
  std::string stage_, unit_;
  int64_t total_ = 0, already_ = 0, done_ = 0, shown_ = 0;
  double begun_ = 0, shown_at_ = 0;
  size_t shown_width_ = 0;
  bool active_ = false;
};

// Whether `out` is a terminal that can redraw a line (TERM is set and not "dumb").
bool can_redraw(std::FILE* out);

// One line, without its end: "trace: 120 of 512 frames, 23 %, 3.1/s, 2 min 6 s left". Rate and time left come from the steps
// of this run alone (`already` were there before).
std::string progress_line(const std::string& stage, const std::string& unit, int64_t done, int64_t total, int64_t already,
                          double seconds);

// "8 s", "2 min 6 s", "3 h 5 min".
std::string duration_text(double seconds);

}  // namespace vitrine
