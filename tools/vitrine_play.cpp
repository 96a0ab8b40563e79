// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// vitrine-play: plays an image.
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>

#include "tools/one_line.h"
#include "tools/player.h"
#include "tools/standard_output.h"

namespace {

void stop(int signal) { vitrine::stop_signal = signal; }

void handle_signals() {
  struct sigaction action {};
  action.sa_handler = stop;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

int report(const std::exception& error, int code) {
  std::fprintf(stderr, "%s\n", vitrine::one_line(std::string("vitrine-play: ") + error.what()).c_str());
  return code;
}

}  // namespace

int main(int argc, char** argv) try {
  const auto options = vitrine::parse_options(argc, argv);
  if (!options) return vitrine::finish_standard_output(), 0;
  handle_signals();
  vitrine::Player player(*options);
  player.play();
  player.print_stats();
  vitrine::finish_standard_output();
  return 0;
} catch (const vitrine::UsageError& error) {
  return report(error, 2);
} catch (const std::exception& error) {
  return report(error, 1);
}
