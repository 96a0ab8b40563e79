// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// vitrine, the host compiler: see tools/commands for what each subcommand does.
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "host/base/error.h"
#include "host/base/interrupt.h"
#include "host/base/progress.h"
#include "tools/commands/command_line.h"
#include "tools/one_line.h"
#include "tools/standard_output.h"
#include "tools/usage_error.h"

namespace {

int fail(const std::string& message, int code) {
  std::fprintf(stderr, "%s\n", vitrine::one_line("vitrine: " + message).c_str());
  return code;
}

// Large blocks go back to the system as soon as they are free: stages differ in what they need, and the allocator's own rule
// would keep the most that any of them took.
void return_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 256 << 10);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  return_freed_memory();
  vitrine::install_interrupt_handler();
  try {
    if (const auto command = vitrine::parse_command_line(argc, argv)) command();
    vitrine::finish_standard_output();
    return 0;
  } catch (const vitrine::UsageError& error) {
    return fail(error.what(), 2);
  } catch (const vitrine::InputError& error) {
    return fail(error.what(), 1);
  } catch (const vitrine::StandardOutputError& error) {
    return fail(error.what(), 1);
  } catch (const vitrine::Interrupted& error) {
    return fail(error.what(), 130);
  } catch (const std::bad_alloc&) {
    return fail("out of memory: the scene is too large for this machine: lower the resolution or the samples", 1);
  } catch (const std::exception& error) {
    return fail(std::string("internal error: ") + error.what() + ": please report it", 1);
  }
}
