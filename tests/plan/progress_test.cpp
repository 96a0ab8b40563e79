// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "host/base/interrupt.h"
#include "host/base/terminal_progress.h"

namespace vitrine {
namespace {

// A progress that writes to memory under a clock of the test's own.
class ProgressTest : public testing::Test {
 protected:
  void SetUp() override { clear_interrupt(); }
  void TearDown() override {
    std::fclose(out_);
    std::free(text_);
    clear_interrupt();
  }
  TerminalProgress make(bool redraw) {
    return TerminalProgress(out_, redraw, [this] { return now_; });
  }
  std::string text() {
    std::fflush(out_);
    return {text_, size_};
  }
  char* text_ = nullptr;
  size_t size_ = 0;
  std::FILE* out_ = open_memstream(&text_, &size_);
  double now_ = 0;
};

TEST_F(ProgressTest, ALineTellsRateAndTimeLeftOfThisRunAlone) {
  EXPECT_EQ(progress_line("trace", "frames", 120, 520, 20, 50), "trace: 120 of 520 frames, 23 %, 2.0/s, 3 min 20 s left");
  EXPECT_EQ(progress_line("trace", "frames", 12, 20, 10, 50), "trace: 12 of 20 frames, 60 %, 25.0 s each, 3 min 20 s left");
  EXPECT_EQ(progress_line("trace", "frames", 20, 20, 10, 5), "trace: 20 of 20 frames, 100 %, 2.0/s, took 5 s");
  EXPECT_EQ(progress_line("trace", "frames", 7, 20, 7, 5), "trace: 7 of 20 frames, 35 %");
  EXPECT_EQ(progress_line("link", "parts", 0, 0, 0, 0), "link: 0 of 0 parts, 100 %");
}

TEST_F(ProgressTest, DurationsReadWell) {
  EXPECT_EQ(duration_text(0.2), "1 s");
  EXPECT_EQ(duration_text(125.5), "2 min 6 s");
  EXPECT_EQ(duration_text(11100), "3 h 5 min");
}

TEST_F(ProgressTest, ALogGetsFewLinesWithoutControlCharacters) {
  TerminalProgress progress = make(false);
  progress.begin("trace", 1000, 0, "frames");
  for (int i = 0; i < 1000; ++i) {
    now_ += 0.05;
    progress.advance(1);
  }
  progress.end();
  const std::string log = text();
  const auto lines = std::count(log.begin(), log.end(), '\n');
  EXPECT_GE(lines, 9);
  EXPECT_LE(lines, 12);
  EXPECT_EQ(log.find('\r'), std::string::npos);
  const std::string last = "trace: 1000 of 1000 frames, 100 %";
  EXPECT_NE(log.find(last), std::string::npos);
  EXPECT_EQ(log.find(last), log.rfind(last)) << "the last line is said once";
}

TEST_F(ProgressTest, ASlowStageSpeaksEveryTenSeconds) {
  TerminalProgress progress = make(false);
  progress.begin("trace", 100000, 0, "frames");
  for (int i = 0; i < 60; ++i) {
    now_ += 1;
    progress.advance(1);
  }
  const std::string log = text();
  EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 6);
}

TEST_F(ProgressTest, ATerminalLineIsRedrawnInPlaceAndLeftClean) {
  TerminalProgress progress = make(true);
  progress.begin("trace", 10, 0, "frames");
  for (int i = 0; i < 10; ++i) {
    now_ += 1;
    progress.advance(1);
  }
  progress.end();
  const std::string screen = text();
  EXPECT_EQ(std::count(screen.begin(), screen.end(), '\n'), 1);
  EXPECT_EQ(screen.back(), '\n');
  EXPECT_GE(std::count(screen.begin(), screen.end(), '\r'), 10);
}

TEST_F(ProgressTest, AStageThatWasLeftByAnErrorEndsItsLine) {
  {
    TerminalProgress progress = make(true);
    progress.begin("trace", 10, 0, "frames");
    progress.advance(1);
  }
  EXPECT_EQ(text().back(), '\n');
}

TEST_F(ProgressTest, CtrlCUnwindsTheNextStep) {
  TerminalProgress progress = make(false);
  install_interrupt_handler();
  progress.begin("trace", 10, 0, "frames");
  progress.advance(1);
  std::raise(SIGINT);
  EXPECT_THROW(progress.advance(1), Interrupted);
  EXPECT_NO_THROW(silent_progress().advance(1));
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

TEST_F(ProgressTest, ManyThreadsMayAdvance) {
  TerminalProgress progress = make(false);
  progress.begin("trace", 4000, 0, "frames");
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 1000; ++i) progress.advance(1);
    });
  for (std::thread& thread : threads) thread.join();
  progress.end();
  EXPECT_NE(text().find("4000 of 4000"), std::string::npos);
}

}  // namespace
}  // namespace vitrine
