// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "host/base/terminal_progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "host/base/interrupt.h"

namespace vitrine {
namespace {

constexpr double kRedrawSeconds = 0.1, kPlainSeconds = 10, kShortestPlainSeconds = 1;

double steady_seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

int percent(int64_t done, int64_t total) { return total > 0 ? static_cast<int>(100 * done / total) : 100; }

}  // namespace

std::string duration_text(double seconds) {
  const int64_t s = static_cast<int64_t>(std::ceil(std::clamp(seconds, 0.0, 1e9)));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

std::string progress_line(const std::string& stage, const std::string& unit, int64_t done, int64_t total, int64_t already,
                          double seconds) {
  std::string line = fmt::format("{}: {} of {} {}, {} %", stage, done, total, unit, percent(done, total));
  const double fresh = static_cast<double>(done - already);
  if (fresh <= 0 || seconds <= 0) return line;
  const double rate = fresh / seconds;
  line += rate >= 1 ? fmt::format(", {:.1f}/s", rate) : fmt::format(", {:.1f} s each", 1 / rate);
  if (done >= total) return line + ", took " + duration_text(seconds);
  return line + ", " + duration_text(static_cast<double>(total - done) / rate) + " left";
}

bool can_redraw(std::FILE* out) {
  const char* term = std::getenv("TERM");
  return isatty(fileno(out)) != 0 && term != nullptr && *term != '\0' && std::string_view(term) != "dumb";
}

TerminalProgress::TerminalProgress(std::FILE* out, bool redraw, Clock clock)
    : out_(out), redraw_(redraw), clock_(clock ? std::move(clock) : Clock(steady_seconds)) {}

TerminalProgress::~TerminalProgress() {
  const std::lock_guard lock(mutex_);
  finish();
}

void TerminalProgress::begin(const char* stage, int64_t total, int64_t already, const char* unit) {
  const std::lock_guard lock(mutex_);
  finish();
  stage_ = stage;
  unit_ = unit;
  total_ = total;
  already_ = done_ = shown_ = already;
  begun_ = shown_at_ = clock_();
  active_ = true;
  if (redraw_) show(begun_, false);
}

void TerminalProgress::advance(int64_t steps) {
  if (interrupt_requested()) throw Interrupted();
  const std::lock_guard lock(mutex_);
  done_ += steps;
  const double now = clock_();
  if (active_ && is_due(now)) show(now, false);
}

void TerminalProgress::end() {
  const std::lock_guard lock(mutex_);
  if (!active_) return;
  show(clock_(), true);
  active_ = false;
}

bool TerminalProgress::is_due(double now) const {
  if (redraw_) return now - shown_at_ >= kRedrawSeconds;
  if (done_ >= total_) return false;  // end() says it
  return now - shown_at_ >= kPlainSeconds || (now - shown_at_ >= kShortestPlainSeconds && (done_ - shown_) * 10 >= total_);
}

void TerminalProgress::show(double now, bool last) {
  write_line(progress_line(stage_, unit_, done_, total_, already_, now - begun_), last);
  shown_at_ = now;
  shown_ = done_;
}

void TerminalProgress::write_line(const std::string& line, bool last) {
  if (redraw_) {
    const std::string padding(shown_width_ > line.size() ? shown_width_ - line.size() : 0, ' ');
    write(fmt::format("\r{}{}{}", line, padding, last ? "\n" : ""));
    shown_width_ = last ? 0 : line.size();
  } else {
    write(line + '\n');
  }
}

// A terminal that went away or a full disk under the log is no reason to lose a night's work: failures are not even looked at.
void TerminalProgress::write(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), out_);
  std::fflush(out_);
}

// A stage that was left without end(), by an error or Ctrl-C: the cursor goes to a fresh line.
void TerminalProgress::finish() {
  if (active_ && redraw_) write("\n");
  shown_width_ = 0;
  active_ = false;
}

}  // namespace vitrine
