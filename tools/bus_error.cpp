// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
#include "tools/bus_error.h"

#include <signal.h>
#include <unistd.h>

#include "tools/one_line.h"

namespace vitrine {
namespace {

std::string message;  // made beforehand: a signal handler may not allocate

void on_bus_error(int) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, message.data(), message.size());
  ::_exit(1);
}

}  // namespace

void explain_bus_errors(const std::string& program, const std::string& file) {
  message = one_line(program + ": " + file + ": it changed or became unreadable while it was in use: replace an image with mv, not with cp") + '\n';
  struct sigaction action {};
  action.sa_handler = on_bus_error;
  sigemptyset(&action.sa_mask);
  sigaction(SIGBUS, &action, nullptr);
}

}  // namespace vitrine
